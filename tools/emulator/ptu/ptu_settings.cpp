#include "tools/emulator/ptu/ptu_settings.hpp"

namespace slamsensor::tools {

PtuSettings ptu_settings(PtuKind kind) {
  PtuSettings settings;
  settings.model = ptu_model(kind);
  if (settings.model.series == PtuSeries::E) {
    settings.wording = ptu_wording(PtuFirmware::FlirE33);
    settings.leading_lf = PtuLeadingLf::AfterLine;
    settings.reset_words = PtuResetWords::ChooseAndReset;
    settings.start_reports = PtuStartReports::Silent;
  }
  return settings;
}

}  // namespace slamsensor::tools
