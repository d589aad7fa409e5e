// Results of runs come from files that other computers have written. What is read as one is what its bytes are of.
#include <cstdint>
#include <string_view>

#include "peerd/lab/cluster/result_bytes.hpp"
#include "peerd/lab/cluster/slurm.hpp"
#include "peerd/lab/cluster/work_list.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using peerd::fuzz::require;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace peerd::cluster;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (const auto result = run_result_from(bytes)) require(to_bytes(*result) == bytes);
  if (const auto report = chaos_report_from(bytes)) require(to_bytes(*report) == bytes);
  constexpr std::size_t kItems = 1000;
  if (const auto range = item_range_from(bytes, kItems)) {
    const auto again = item_range_from(range_text({range->first, range->last}), kItems);
    require(again && again->first == range->first && again->last == range->last);
  }
  if (const auto job = slurm_job_from(bytes)) require(slurm_job_from(to_text(*job)).has_value());
  return 0;
}
