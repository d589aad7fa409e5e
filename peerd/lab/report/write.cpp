#include "peerd/lab/report/write.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <regex>
#include <string_view>
#include <system_error>
#include <vector>

#include "peerd/input/json_text.hpp"
#include "peerd/lab/measure/csv.hpp"
#include "peerd/lab/report/figures.hpp"
#include "peerd/lab/report/page.hpp"

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

// Whether earlier versions of the program wrote a picture of that name.
bool is_old_picture(const std::string& name) {
  static const std::regex kName(R"((overview|plan|pareto|multiples|(run|timeline)-\d{3,8})\.svg)");
  return std::regex_match(name, kName);
}

std::expected<void, std::string> remove_old_pictures(const fs::path& out) {
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator it(out, error), end; !error && it != end; it.increment(error)) {
    if (is_old_picture(it->path().filename().string())) old.push_back(it->path());
  }
  for (const fs::path& path : old) {
    if (!error) fs::remove(path, error);
  }
  if (error)
    return std::unexpected("cannot remove the pictures of an earlier run in " + out.string() + ": " + error.message());
  return {};
}

}  // namespace

std::expected<void, std::string> write_report(const fs::path& out, const measure::ScenarioInfo& info,
                                              std::span<const measure::RunRecord> runs) {
  return write_report(out, info, runs, measure::summarise(info, runs));
}

std::expected<void, std::string> write_report(const fs::path& out, const measure::ScenarioInfo& info,
                                              std::span<const measure::RunRecord> runs,
                                              const nlohmann::ordered_json& summary) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return std::unexpected("cannot make the directory " + out.string() + ": " + error.message());
  if (auto done = remove_old_pictures(out); !done) return done;
  if (auto done = write_file(out / "errors.csv", measure::errors_csv(runs, info.csv_rows)); !done) return done;
  if (auto done = write_file(out / "traffic.csv", measure::traffic_csv(runs, info.csv_rows)); !done) return done;
  if (auto done = write_file(out / "collisions.csv", measure::collisions_csv(runs)); !done) return done;
  if (auto done = write_file(out / "report.html", report_page(info, runs, summary, make_figures(info, runs, summary)));
      !done)
    return done;
  // summary.json is written last: a reader that finds it finds the rest.
  return write_file(out / "summary.json", json_text(summary) + '\n');
}

}  // namespace peerd::report
