#include "peerd/report/write.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

#include "peerd/report/csv.hpp"
#include "peerd/report/figures.hpp"

namespace peerd::report {
namespace {

namespace fs = std::filesystem;

std::expected<void, std::string> write_file(const fs::path& path, std::string_view text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (file.fail()) {
    return std::unexpected("cannot write " + path.string() + ": " +
                           (errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
  return {};
}

std::string picture_name(std::size_t number) {
  const std::string digits = std::to_string(number);
  return "run-" + std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits + ".svg";
}

// The number in run-NNN.svg, 0 for every other name.
std::size_t picture_number(const std::string& name) {
  if (!name.starts_with("run-") || !name.ends_with(".svg") || name.size() < 11 || name.size() > 16) return 0;
  const std::string digits = name.substr(4, name.size() - 8);
  if (!std::ranges::all_of(digits, [](unsigned char c) { return std::isdigit(c) != 0; })) return 0;
  return std::stoul(digits);
}

std::expected<void, std::string> remove_old_pictures(const fs::path& out, std::size_t runs) {
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator it(out, error), end; !error && it != end; it.increment(error)) {
    const std::size_t number = picture_number(it->path().filename().string());
    if (number > runs) old.push_back(it->path());
  }
  for (const fs::path& path : old) {
    if (!error) fs::remove(path, error);
  }
  if (error)
    return std::unexpected("cannot remove the pictures of an earlier run in " + out.string() + ": " + error.message());
  return {};
}

}  // namespace

std::expected<void, std::string> write_report(const fs::path& out, const ScenarioInfo& info,
                                              std::span<const RunRecord> runs) {
  return write_report(out, info, runs, summarise(info, runs));
}

std::expected<void, std::string> write_report(const fs::path& out, const ScenarioInfo& info,
                                              std::span<const RunRecord> runs, const nlohmann::ordered_json& summary) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return std::unexpected("cannot make the directory " + out.string() + ": " + error.message());
  if (auto done = remove_old_pictures(out, runs.size()); !done) return done;

  const FigureFrame frame = figure_frame(runs, summary);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (auto done = write_file(out / picture_name(i + 1), run_figure(info, runs[i], i + 1, frame)); !done) return done;
  }
  if (auto done = write_file(out / "overview.svg", overview_figure(summary)); !done) return done;
  if (auto done = write_file(out / "plan.svg", plan_figure(info, runs, summary)); !done) return done;
  if (auto done = write_file(out / "errors.csv", errors_csv(runs)); !done) return done;
  if (auto done = write_file(out / "traffic.csv", traffic_csv(runs)); !done) return done;
  if (auto done = write_file(out / "collisions.csv", collisions_csv(runs)); !done) return done;
  // Last: who finds a summary.json finds the rest.
  using Json = nlohmann::ordered_json;
  return write_file(out / "summary.json", summary.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace peerd::report
