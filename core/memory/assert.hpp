#pragma once

/// Stops the process when one of our own invariants is broken, in every build type (a trap: no I/O, no
/// unwinding). Bad input is never asserted, it is refused with a status.
#define SLAMSENSOR_ASSERT(condition) \
  do {                               \
    if (!(condition)) {              \
      __builtin_trap();              \
    }                                \
  } while (false)
