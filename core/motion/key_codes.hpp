#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

namespace peerd {

// One press of a key in the numbers of Qt, as keyValue and keyState of a KeySensor have them: Qt::Key, Qt::ButtonState.
struct KeyEvent {
  std::int32_t value = 0;
  std::int32_t state = 0;
  bool is_release = false;  // the key goes up
  friend constexpr bool operator==(const KeyEvent&, const KeyEvent&) = default;
};

// The modifier that is held down with the key.
struct KeyModifiers {
  bool shift = false, control = false, alt = false, meta = false;
  bool keypad = false;  // the key stands on the numeric keypad
};

// The numbers of Qt 3 (qnamespace.h of 2002; the thesis is of 2003). All keys that are no characters are 0x1000 and up.
namespace qt3 {
inline constexpr std::int32_t kEscape = 0x1000, kTab = 0x1001, kBacktab = 0x1002, kReturn = 0x1004, kEnter = 0x1005;
inline constexpr std::int32_t kShift = 0x1020, kControl = 0x1021, kMeta = 0x1022, kAlt = 0x1023, kF1 = 0x1030;
inline constexpr std::int32_t kShiftButton = 0x0100, kControlButton = 0x0200, kAltButton = 0x0400, kMetaButton = 0x0800,
                              kKeypad = 0x4000;
}  // namespace qt3

// Returns the same press in one form, whatever wrote it. Two presses are the same where their canonical forms are
// equal:
// - value: Qt 4 to 6 have 0x01000000 + n where Qt 3 has 0x1000 + n, up to n = 0xb1; beyond there is no Qt 3 code, and
// the code stays. Letters are upper case: Qt has no others, but for the Latin-1 ones of Qt 3.
// - state: Qt 4 to 6 have the modifiers from 0x02000000 (Shift) to 0x20000000 (keypad). The flag of a modifier key
// itself is dropped: Qt 3 gives the state before the press, Qt 4 to 6 and browsers the one after it.
// Tab with Shift is Backtab, as Qt delivers it.
// A release has no state: whoever holds two keys lets go of them in any order.
[[nodiscard]] KeyEvent canonical(const KeyEvent& key);

// Returns a key by its name in a browser: KeyboardEvent.key of W3C's UI Events ("ArrowUp", "a", "Enter", " ", "F1",
// "Shift"). The case of a letter says nothing, `shift` does: Caps Lock is no modifier to Qt either. The result is in
// canonical form; the error is a sentence with the name that was probably meant.
[[nodiscard]] std::expected<KeyEvent, std::string> find_key(std::string_view name, const KeyModifiers& modifiers = {});

// Returns a key by its name with the modifiers before it: "ArrowUp", "shift+ArrowUp", "control+shift+a", "+".
[[nodiscard]] std::expected<KeyEvent, std::string> find_held_key(std::string_view name);

// Returns a description for messages: "shift+ArrowUp", "release of ArrowUp", or "key 4294 with state 7" where the key
// has no name.
[[nodiscard]] std::string name_of(const KeyEvent& key);

}  // namespace peerd
