#include "board/board.h"
