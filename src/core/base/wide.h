// SPDX-License-Identifier: BSD-3-Clause
// Loops that use the wide registers of a processor where it has them.
#pragma once

// GCC 12 takes a vector that is made of four numbers for one that is read before it is made.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

// Functions that are part of the loops that call them: vectors are not passed about.
#define RBS_INLINE [[gnu::always_inline]] inline
// Compiled twice, for processors with AVX2 and without; which to take is found out when the program starts.
// Both give the same bits: they differ in how many numbers an instruction has. Clang, which fuzzing uses, wants
// such functions declared before they are called; it compiles them once.
#if defined(__x86_64__) && !defined(__clang__)
#define RBS_WIDE [[gnu::target_clones("avx2", "default")]]
#else
#define RBS_WIDE
#endif
