// BELTPICK_KERNEL: marks a hot function to be compiled for several vector units, chosen when the program starts. The
// source that holds it asks for -O3 -ffp-contract=off (beltpick_kernel_sources in CMake): fused operations round
// differently, and the result must be the same bits whichever version runs. BELTPICK_PLAIN_KERNELS: the baseline
// version alone, to compare with.
#pragma once

#if defined(__x86_64__) && !defined(BELTPICK_PLAIN_KERNELS) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BELTPICK_KERNEL __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define BELTPICK_KERNEL
#endif
