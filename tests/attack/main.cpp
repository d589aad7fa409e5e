// The program `peerd-attacker`: one attack on the peers of a session, for scripts/attack.
#include <algorithm>
#include <iostream>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tests/attack/attacks.hpp"

int main(int argc, char** argv) {
  using namespace peerd::attack;
  std::vector<Attack> all;
  for (const auto& some : {identity_attacks(), signature_attacks(), edit_attacks(), join_attacks()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  CLI::App app("one attack on the peers of a session, to be run in a network namespace of its own");
  Target target;
  std::string name;
  app.add_option("name", name, "which attack; without it all are listed");
  app.add_option("--world", target.world, "the world's name");
  app.add_option("--interface", target.interface, "the network interface");
  app.add_option("--key", target.key_file, "the file of the session's key");
  app.add_option("--identity", target.identity_file, "the file of who the attacker is (default: somebody new)");
  app.add_option("--number", target.number, "the number of the peer that it says it is (default: a random one)");
  app.add_option("--port", target.port, "the session's UDP port");
  app.add_option("--seconds", target.seconds, "how long");
  app.add_option("--rate", target.rate, "how often in a second (default: the attack's own)");
  app.add_option("--count", target.count, "how many at once (default: the attack's own)");
  app.add_option("--at", target.at, "ADDRESS:PORT of a peer that gives the world by TCP");
  CLI11_PARSE(app, argc, argv);
  if (name.empty()) {
    for (const Attack& each : all) std::cout << each.name << '\t' << each.sentence << '\n';
    return 0;
  }
  const auto attack = std::ranges::find(all, name, &Attack::name);
  if (attack == all.end()) {
    std::cerr << "error: there is no attack " << name << '\n';
    return 2;
  }
  end_on_signals();
  std::cout << nlohmann::json(attack->run(target)).dump() << std::endl;
}
