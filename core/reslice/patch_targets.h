// Which instruction sets Highway compiles the kernels of patches for; comes before Highway's headers.
#pragma once

// Ice Lake, Zen 4 and later: byte permutes.
#define HWY_WANT_AVX3_DL 1

// None above it: the sets that Highway 1.2 adds for later processors (AVX3_ZEN4, AVX3_SPR) bring nothing
// here, and are not HWY_AVX3_DL where the kernels ask for that. Their bits are the lower ones; Highway 1.0
// has none there.
#define HWY_DISABLED_TARGETS (HWY_AVX3_DL - 1)
