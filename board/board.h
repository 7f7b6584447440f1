// Which devices this machine has.
#pragma once
