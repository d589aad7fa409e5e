#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "peerd/cli/program/commands.hpp"
#include "peerd/cli/program/help_topics.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/cli/shell/wrong_use.hpp"

namespace peerd {
Command add_help(CLI::App& app) {
  const auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* const command = app.add_subcommand(
      "help", "the help of a command, a page on a topic (peerd help topics lists them), or this one");
  command->footer("Exit codes: 0 good, 2 there is no such command or topic");
  command->add_option("command", *words,
                      "its name, such as sim or ctl key, or that of a topic (default: that of peerd)");
  return {command, [words, &app] {
            if (*words == std::vector<std::string>{"topics"}) {
              std::cout << "peerd help TOPIC, of:\n" << list_of_topics(help_pages());
              return 0;
            }
            const CLI::App* asked = &app;
            for (const std::string& word : *words) {
              const auto found = find_command(*asked, word);
              const auto page = found || words->size() > 1 ? std::nullopt : help_on(word, help_pages());
              if (page) {
                std::cout << *page;
                return 0;
              }
              if (!found) return failed({found.error().text + ", or peerd help topics", kWrongUse});
              asked = *found;
            }
            std::cout << help_of(*asked);
            return 0;
          }};
}

const char* program_version() { return "peerd " PEERD_VERSION; }

Command add_version(CLI::App& app) {
  return {app.add_subcommand("version", "the version of this program"), [] {
            std::cout << program_version() << '\n';
            return 0;
          }};
}

}  // namespace peerd
