#include "peerd/cli/commands/view_command.hpp"

#include <filesystem>
#include <iostream>

#include <nlohmann/json.hpp>

#include "peerd/cli/client/peer_replies.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/peer/control/control_path.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;

constexpr int kNoPage = 3;

int view_peer(const fs::path& socket) {
  const auto reply = ask_peer(socket, R"({"do":"viewer"})");
  if (!reply) return failed(reply.error());
  const auto url = reply->find("viewer");
  if (url == reply->end() || !url->is_string()) {
    return failed({"error: the peer at " + socket.string() +
                       " serves no page; start it with --view, or set gateway.listen in its configuration",
                   kNoPage});
  }
  std::cout << url->get<std::string>() << '\n';
  return 0;
}

}  // namespace

int run_view(const ViewOptions& options, const std::function<int(const ViewOptions&)>& view_recorded) {
  if (options.what.empty()) {
    const auto socket = control::find_socket(options.name);
    return socket ? view_peer(*socket) : failed(socket.error());
  }
  std::error_code error;
  const fs::file_status status = fs::status(options.what, error);
  if (!fs::exists(status)) return failed({"error: there is no " + options.what, kWrongUse});
  return fs::is_socket(status) ? view_peer(options.what) : view_recorded(options);
}

}  // namespace peerd
