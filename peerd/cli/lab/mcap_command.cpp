#include "peerd/cli/lab/mcap_command.hpp"

#include <cerrno>
#include <fstream>
#include <ostream>

#include <nlohmann/json.hpp>

#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/lab/recorded/record_capture.hpp"
#include "peerd/lab/recorded/record_run.hpp"
#include "peerd/lab/recorded/recording_export.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

}  // namespace

int run_mcap_export(const McapOptions& options, std::ostream& out, std::ostream& err) {
  std::ostream* const json = options.json ? &out : nullptr;
  if (!fs::exists(options.what)) return print_error({"error: there is no " + options.what, 2}, err, json);
  Scenes scenes;
  const auto keep_scene = [&](PeerId view, double t_s, const view::ScenePicture& scene) {
    scenes[view].push_back({t_s, scene});
  };
  const auto recording = recorded::record(
      {.path = options.what, .world = options.world, .size_max_mib = options.size_max_mib}, options.run,
      {.hz = options.hz, .most_bytes = options.memory_mib * kMiB, .on_scene = keep_scene});
  if (!recording) return print_error(recording.error(), err, json);
  errno = 0;
  std::ofstream file(options.file, std::ios::binary | std::ios::trunc);
  if (!file) return print_error(unwritable(options.file, errno), err, json);
  RecordingExport written(file);
  written.add(*recording, scenes);
  file.close();
  if (!file) return print_error(half_written(options.file, errno), err, json);
  for (const std::string& note : recording->notes) err << "warning: " << note << '\n';
  if (!options.json) {
    out << options.file.string() << ": " << counted(written.size_bytes(), "byte") << ", "
        << counted(written.messages(), "message") << " of " << counted(recording->views.size(), "view") << " over "
        << recording->end_s << " s\n";
    return 0;
  }
  Json views = Json::array();
  for (const auto& view : recording->views) views.push_back({{"peer", view.peer.value}, {"name", view.name}});
  const Json all = {{"what", options.what},
                    {"file", options.file.string()},
                    {"bytes", written.size_bytes()},
                    {"messages", written.messages()},
                    {"views", views},
                    {"duration_s", recording->end_s},
                    {"notes", recording->notes}};
  out << json_text(all) << '\n';
  return 0;
}

}  // namespace peerd
