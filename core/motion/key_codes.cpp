#include "core/motion/key_codes.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <optional>

#include "core/suggestion.hpp"

namespace peerd {
namespace {

struct NamedKey {
  std::string_view name;  // UI Events KeyboardEvent key Values
  std::int32_t value;     // Qt 3; AltGraph, which Qt 3 does not know, Qt 4 to 6
};
constexpr std::array kNamedKeys = {
    NamedKey{"Escape", 0x1000},
    NamedKey{"Tab", 0x1001},
    NamedKey{"Backspace", 0x1003},
    NamedKey{"Enter", 0x1004},  // the main one is Qt's Key_Return, the keypad's Qt's Key_Enter
    NamedKey{"Insert", 0x1006},
    NamedKey{"Delete", 0x1007},
    NamedKey{"Pause", 0x1008},
    NamedKey{"PrintScreen", 0x1009},
    NamedKey{"Clear", 0x100b},
    NamedKey{"Home", 0x1010},
    NamedKey{"End", 0x1011},
    NamedKey{"ArrowLeft", 0x1012},
    NamedKey{"ArrowUp", 0x1013},
    NamedKey{"ArrowRight", 0x1014},
    NamedKey{"ArrowDown", 0x1015},
    NamedKey{"PageUp", 0x1016},
    NamedKey{"PageDown", 0x1017},
    NamedKey{"Shift", 0x1020},
    NamedKey{"Control", 0x1021},
    NamedKey{"Meta", 0x1022},
    NamedKey{"Alt", 0x1023},
    NamedKey{"CapsLock", 0x1024},
    NamedKey{"NumLock", 0x1025},
    NamedKey{"ScrollLock", 0x1026},
    NamedKey{"Super", 0x1053},
    NamedKey{"ContextMenu", 0x1055},
    NamedKey{"Hyper", 0x1056},
    NamedKey{"Help", 0x1058},
    NamedKey{"BrowserBack", 0x1061},
    NamedKey{"BrowserForward", 0x1062},
    NamedKey{"BrowserStop", 0x1063},
    NamedKey{"BrowserRefresh", 0x1064},
    NamedKey{"AudioVolumeDown", 0x1070},
    NamedKey{"AudioVolumeMute", 0x1071},
    NamedKey{"AudioVolumeUp", 0x1072},
    NamedKey{"AudioBassBoostToggle", 0x1073},
    NamedKey{"AudioBassBoostUp", 0x1074},
    NamedKey{"AudioBassBoostDown", 0x1075},
    NamedKey{"AudioTrebleUp", 0x1076},
    NamedKey{"AudioTrebleDown", 0x1077},
    NamedKey{"MediaPlay", 0x1080},
    NamedKey{"MediaStop", 0x1081},
    NamedKey{"MediaTrackPrevious", 0x1082},
    NamedKey{"MediaTrackNext", 0x1083},
    NamedKey{"MediaRecord", 0x1084},
    NamedKey{"BrowserHome", 0x1090},
    NamedKey{"BrowserFavorites", 0x1091},
    NamedKey{"BrowserSearch", 0x1092},
    NamedKey{"Standby", 0x1093},
    NamedKey{"LaunchMail", 0x10a0},
    NamedKey{"LaunchMediaPlayer", 0x10a1},
    NamedKey{"AltGraph", 0x0100'1103},
};
constexpr int kFunctionKeys = 35;  // Qt 3's F1 to F35 follow each other

struct Modifier {
  std::string_view name;
  bool KeyModifiers::*flag;
  std::int32_t qt3, qt4;  // flag in the state
  std::int32_t key = 0;   // the key that sets the flag, in Qt 3's numbers
};
constexpr std::array kModifiers = {
    Modifier{"shift", &KeyModifiers::shift, qt3::kShiftButton, 0x0200'0000, qt3::kShift},
    Modifier{"control", &KeyModifiers::control, qt3::kControlButton, 0x0400'0000, qt3::kControl},
    Modifier{"alt", &KeyModifiers::alt, qt3::kAltButton, 0x0800'0000, qt3::kAlt},
    Modifier{"meta", &KeyModifiers::meta, qt3::kMetaButton, 0x1000'0000, qt3::kMeta},
    Modifier{"keypad", &KeyModifiers::keypad, qt3::kKeypad, 0x2000'0000},
};

constexpr std::int32_t kQt3Keys = 0x1000, kQt4Keys = 0x0100'0000;
constexpr std::int32_t kLastShared = 0xb1;  // LaunchF: from there on Qt 4 to 6 number keys that Qt 3 does not know

constexpr std::int32_t canonical_value(std::int32_t value) {
  if (value >= kQt4Keys && value <= kQt4Keys + kLastShared) return value - kQt4Keys + kQt3Keys;
  if (value >= 'a' && value <= 'z') return value - 'a' + 'A';
  // The exceptions of Latin-1 are 0xf7, the division sign, and 0xff, which has its upper case elsewhere.
  if (value >= 0xe0 && value <= 0xfe && value != 0xf7) return value - 0x20;
  return value;
}
static_assert(canonical_value(0x0100'0013) == 0x1013);

std::optional<std::int32_t> find_function_key(std::string_view name) {
  int number = 0;
  if (name.size() < 2 || name[0] != 'F' || name[1] == '0') return std::nullopt;
  const auto [end, error] = std::from_chars(name.data() + 1, name.data() + name.size(), number);
  if (error != std::errc{} || end != name.data() + name.size() || number < 1 || number > kFunctionKeys) {
    return std::nullopt;
  }
  return qt3::kF1 + number - 1;
}

// Returns the code of a name of one character, in UTF-8: the character that the key types. Qt 3 numbers the characters
// of Latin-1 as Latin-1 does.
std::optional<std::int32_t> find_character(std::string_view name) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(name[i]); };
  if (name.size() == 1 && byte(0) >= 0x20 && byte(0) < 0x7f) return byte(0);
  if (name.size() != 2 || (byte(0) != 0xc2 && byte(0) != 0xc3) || (byte(1) & 0xc0) != 0x80) return std::nullopt;
  const std::int32_t value = (byte(0) & 0x03) << 6 | (byte(1) & 0x3f);
  return value >= 0xa0 ? std::optional(value) : std::nullopt;
}

std::optional<std::int32_t> find_value(std::string_view name) {
  if (name == "Space" || name == "Spacebar") return ' ';
  if (const auto character = find_character(name)) return character;
  if (const auto function = find_function_key(name)) return function;
  const auto at = std::ranges::find(kNamedKeys, name, &NamedKey::name);
  return at == kNamedKeys.end() ? std::nullopt : std::optional(at->value);
}

}  // namespace

KeyEvent canonical(const KeyEvent& key) {
  KeyEvent c{canonical_value(key.value), key.state, key.is_release};
  if (c.is_release) {
    if (c.value == qt3::kBacktab) c.value = qt3::kTab;
    c.state = 0;
    return c;
  }
  for (const Modifier& m : kModifiers) {
    const bool held = (c.state & (m.qt3 | m.qt4)) != 0;
    c.state &= ~(m.qt3 | m.qt4);
    if (held && (m.key == 0 || m.key != c.value)) c.state |= m.qt3;
  }
  if (c.value == qt3::kTab && (c.state & qt3::kShiftButton) != 0) c.value = qt3::kBacktab;
  return c;
}

std::expected<KeyEvent, std::string> find_key(std::string_view name, const KeyModifiers& modifiers) {
  const auto value = find_value(name);
  if (!value) {
    std::string sentence = "there is no key \"" + std::string(name) + "\"";
    Suggestion suggestion(name);
    for (const NamedKey& key : kNamedKeys) suggestion.consider(key.name);
    suggestion.consider("Space");
    if (const auto meant = suggestion.best()) {
      return std::unexpected(sentence + "; did you mean \"" + std::string(*meant) + "\"?");
    }
    return std::unexpected(sentence + "; keys have a browser's names, such as \"ArrowUp\", \"a\", \"Enter\" or \"F1\"");
  }
  KeyEvent key{*value, 0};
  if (key.value == qt3::kReturn && modifiers.keypad) key.value = qt3::kEnter;
  for (const Modifier& m : kModifiers) {
    if (modifiers.*m.flag) key.state |= m.qt3;
  }
  return canonical(key);
}

std::expected<KeyEvent, std::string> find_held_key(std::string_view name) {
  KeyModifiers held;
  for (std::size_t plus = name.find('+'); plus != std::string_view::npos && plus + 1 < name.size();) {
    if (plus == 0) break;  // the key is +
    const auto modifier = std::ranges::find(kModifiers, name.substr(0, plus), &Modifier::name);
    if (modifier == kModifiers.end()) {
      return std::unexpected("there is no modifier \"" + std::string(name.substr(0, plus)) +
                             "\"; there are shift, control, alt, meta and keypad");
    }
    held.*modifier->flag = true;
    name.remove_prefix(plus + 1);
    plus = name.find('+');
  }
  return find_key(name, held);
}

std::string name_of(const KeyEvent& key) {
  const KeyEvent c = canonical(key);
  std::string name = c.is_release ? "release of " : "";
  std::int32_t unnamed = c.state;
  for (const Modifier& m : kModifiers) {
    if ((c.state & m.qt3) != 0) name += std::string(m.name) + "+";
    unnamed &= ~m.qt3;
  }
  const auto at = std::ranges::find(kNamedKeys, c.value, &NamedKey::value);
  if (unnamed != 0) {
    return name + "key " + std::to_string(key.value) + " with state " + std::to_string(key.state);
  } else if (at != kNamedKeys.end()) {
    return name + std::string(at->name);
  } else if (c.value == qt3::kBacktab) {
    return name + "Tab";
  } else if (c.value == qt3::kEnter) {
    return name + "Enter";
  } else if (c.value >= qt3::kF1 && c.value < qt3::kF1 + kFunctionKeys) {
    return name + "F" + std::to_string(c.value - qt3::kF1 + 1);
  } else if (c.value == ' ') {
    return name + "\" \"";
  } else if (c.value > ' ' && c.value < 0x7f) {
    return name + static_cast<char>(c.value);
  }
  return "key " + std::to_string(key.value) + " with state " + std::to_string(key.state);
}

}  // namespace peerd
