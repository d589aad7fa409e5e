#pragma once

namespace peerd::report {

// The measures [px] that the figures of one run share, so that the same instant stands at the same place in both.
struct TimeFigureLayout {
  static constexpr double kWidth = 800.0;
  static constexpr double kLeft = 70.0;        // width of the numbers beside the plots
  static constexpr double kPlotWidth = 710.0;  // length of the time axis
};

}  // namespace peerd::report
