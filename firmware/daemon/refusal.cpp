#include "firmware/daemon/refusal.hpp"

#include <utility>

namespace slamsensor::firmware {

tl::unexpected<ControlError> refusal(ControlErrorCode code, std::string text) {
  return tl::unexpected(ControlError{code, std::move(text)});
}

tl::unexpected<ControlError> refusal(const StoreError& error) {
  switch (error.fault) {
    case StoreFault::Name:
      return refusal(ControlErrorCode::Value, error.message);
    case StoreFault::Missing:
      return refusal(ControlErrorCode::NotFound, error.message);
    case StoreFault::Refused:
    case StoreFault::InUse:
      return refusal(ControlErrorCode::Refused, error.message);
    case StoreFault::Io:
      break;
  }
  return refusal(ControlErrorCode::Failed, error.message);
}

}  // namespace slamsensor::firmware
