#include "peerd/cli/commands/bake_command.hpp"

#include <ostream>

#include <nlohmann/json.hpp>

#include "collision/scene/scene_query.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/hierarchy_files.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"

namespace peerd {

int run_bake(const std::string& path, const BakeOptions& options, std::ostream& out, std::ostream& err) {
  std::ostream* const json = options.json ? &out : nullptr;
  const auto file = open_world(path, options.reading, err, json);
  if (!file) return file.error();
  collision::SceneQuery query(*(*file)->result.scene);
  const auto baked = query.bake();
  if (!baked) {
    return print_error({path + ": error: " + baked.error(), 1}, err, json);
  }
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const auto& [url, bytes] : *baked) {
    const auto written = write_hierarchy_file(path, url, bytes);
    if (!written) {
      const std::string sentence = ": error: hierarchyFile \"" + std::string(url) + "\" is not written: ";
      return print_error({path + sentence + written.error(), 3}, err, json);
    }
    files.push_back({{"path", written->string()}, {"bytes", bytes.size()}});
    if (!options.json) out << written->string() << ": " << counted(bytes.size(), "byte") << '\n';
  }
  if (options.json) {
    const nlohmann::ordered_json all = {{"world", path}, {"files", std::move(files)}};
    out << json_text(all) << '\n';
  } else if (baked->empty()) {
    out << path << ": no Shape names a hierarchyFile\n";
  }
  return 0;
}

}  // namespace peerd
