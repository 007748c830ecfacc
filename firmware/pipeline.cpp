#include "firmware/pipeline.hpp"

#include <cstring>
#include <new>

namespace slamsensor::firmware {

Pipeline::Pipeline(const core::Config& config) {
  std::size_t bytes = 0;
  (void)core::plan_memory(config, bytes);
  block_.reset(static_cast<std::byte*>(std::aligned_alloc(core::Arena::kAlignment, bytes)));
  if (!block_) {
    throw std::bad_alloc();
  }
  std::memset(block_.get(), 0, bytes);
  core::Arena arena({block_.get(), bytes});
  slam_ = std::make_unique<core::Slam>(arena, config);
}

}  // namespace slamsensor::firmware
