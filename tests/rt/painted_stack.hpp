#pragma once

#include <cstddef>
#include <functional>

namespace slamsensor::tests {

/// Runs `work` on a thread whose stack of `stack_bytes` was painted beforehand, hence is in memory, and
/// returns how far down `work` wrote: its stack in bytes, rounded up to a word. A stack that overflows ends
/// the process.
std::size_t run_on_painted_stack(std::size_t stack_bytes, const std::function<void()>& work);

}  // namespace slamsensor::tests
