#include "peerd/lab/report/output_rates.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "peerd/lab/report/svg.hpp"

namespace peerd::report {

double output_bin_s(double duration_s) {
  if (duration_s <= 120.0) return 1.0;
  const Ticks ticks = nice_ticks({0.0, duration_s}, 120);
  return std::max(1.0, ticks.at[1] - ticks.at[0]);
}

std::vector<double> output_rates(const measure::RunRecord& run, PeerId sender) {
  const double width_s = output_bin_s(run.duration_s);
  const auto count = static_cast<std::size_t>(std::ceil(run.duration_s / width_s));
  std::vector<double> rates(count, 0.0);
  if (count == 0) return rates;
  const auto add = [&](double t_s, double bytes) {
    rates[std::min(count - 1, static_cast<std::size_t>(t_s / width_s))] += bytes;
  };
  if (run.measured) {  // a bin is a whole number of seconds
    const auto found = run.measured->output_bytes.find(sender);
    const bool sent = found != run.measured->output_bytes.end();
    for (std::size_t second = 0; sent && second < found->second.size(); ++second) {
      add(static_cast<double>(second), static_cast<double>(found->second[second]));
    }
  } else {
    for (const measure::DatagramSent& d : run.datagrams) {
      if (d.sender == sender && d.t_s >= 0.0) add(d.t_s, d.bytes);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double begin_s = static_cast<double>(i) * width_s;
    rates[i] *= 1e-3 / std::min(width_s, run.duration_s - begin_s);
  }
  return rates;
}

}  // namespace peerd::report
