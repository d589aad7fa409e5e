#include "peerd/lab/report/write.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "peerd/lab/measure/csv.hpp"
#include "peerd/lab/report/page.hpp"
#include "peerd/lab/report/pictures.hpp"

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

// The number in a name KIND-NNN.svg, or 0 for every other name.
std::size_t picture_number(const std::string& name, const std::string& kind) {
  if (!name.starts_with(kind + '-') || !name.ends_with(".svg")) return 0;
  const std::string digits = name.substr(kind.size() + 1, name.size() - kind.size() - 5);
  if (digits.size() < 3 || digits.size() > 8) return 0;
  if (!std::ranges::all_of(digits, [](unsigned char c) { return std::isdigit(c) != 0; })) return 0;
  return std::stoul(digits);
}

// Removes pictures of runs that this report does not have, and pictures of a sweep that do not apply to it.
std::expected<void, std::string> remove_old_pictures(const fs::path& out, const Pictures& pictures) {
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator it(out, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const std::size_t number = std::max(picture_number(name, "run"), picture_number(name, "timeline"));
    if (number > pictures.runs.size() || (name == "pareto.svg" && pictures.pareto.empty()) ||
        (name == "multiples.svg" && pictures.multiples.empty()))
      old.push_back(it->path());
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
  const Pictures pictures = draw_pictures(info, runs, summary);
  if (auto done = remove_old_pictures(out, pictures); !done) return done;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Pictures::OfRun& drawn = pictures.runs[i];
    if (auto done = write_file(out / picture_file("run", i + 1), drawn.run); !done) return done;
    if (auto done = write_file(out / picture_file("timeline", i + 1), drawn.timeline); !done) return done;
  }
  for (const auto& [name, svg] :
       {std::pair("overview.svg", &pictures.overview), std::pair("plan.svg", &pictures.plan),
        std::pair("pareto.svg", &pictures.pareto), std::pair("multiples.svg", &pictures.multiples)}) {
    if (svg->empty()) continue;
    if (auto done = write_file(out / name, *svg); !done) return done;
  }
  if (auto done = write_file(out / "errors.csv", measure::errors_csv(runs, info.csv_rows)); !done) return done;
  if (auto done = write_file(out / "traffic.csv", measure::traffic_csv(runs, info.csv_rows)); !done) return done;
  if (auto done = write_file(out / "collisions.csv", measure::collisions_csv(runs)); !done) return done;
  if (auto done = write_file(out / "report.html", report_page(info, runs, summary, pictures)); !done) return done;
  // summary.json is written last: a reader that finds it finds the rest.
  using Json = nlohmann::ordered_json;
  return write_file(out / "summary.json", summary.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace peerd::report
