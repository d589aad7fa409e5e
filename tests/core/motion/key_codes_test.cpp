#include "core/motion/key_codes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace peerd::key_codes_test {

using testing::HasSubstr;

struct Named {
  const char* name;
  KeyModifiers held;
  KeyEvent key;
};
class KeyNames : public testing::TestWithParam<Named> {};
TEST_P(KeyNames, AreQt3sNumbers) {
  const auto& [name, held, key] = GetParam();
  const auto found = find_key(name, held);
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->value, key.value);
  EXPECT_EQ(found->state, key.state);
  EXPECT_EQ(canonical(*found), *found);
}
INSTANTIATE_TEST_SUITE_P(
    Table, KeyNames,
    testing::Values(Named{"Escape", {}, {0x1000, 0}}, Named{"ArrowLeft", {}, {0x1012, 0}},
                    Named{"ArrowUp", {}, {0x1013, 0}}, Named{"ArrowUp", {.shift = true}, {0x1013, 0x100}},
                    Named{"PageDown", {.control = true, .alt = true}, {0x1017, 0x600}},
                    Named{"F1", {.meta = true}, {0x1030, 0x800}}, Named{"F12", {}, {0x103b, 0}},
                    Named{"F35", {}, {0x1052, 0}}, Named{"a", {}, {0x41, 0}}, Named{"A", {}, {0x41, 0}},
                    Named{"A", {.shift = true}, {0x41, 0x100}}, Named{" ", {}, {0x20, 0}}, Named{"!", {}, {0x21, 0}},
                    Named{"~", {}, {0x7e, 0}}, Named{"7", {.keypad = true}, {0x37, 0x4000}},
                    Named{"Enter", {}, {0x1004, 0}}, Named{"Enter", {.keypad = true}, {0x1005, 0x4000}},
                    Named{"Tab", {}, {0x1001, 0}}, Named{"Tab", {.shift = true}, {0x1002, 0x100}},
                    Named{"Shift", {.shift = true}, {0x1020, 0}}, Named{"Shift", {.alt = true}, {0x1020, 0x400}},
                    Named{"ContextMenu", {}, {0x1055, 0}}, Named{"AltGraph", {}, {0x01001103, 0}},
                    Named{"\xc3\xa4", {}, {0xc4, 0}}, Named{"\xc3\x84", {}, {0xc4, 0}},
                    Named{"\xc3\xb7", {}, {0xf7, 0}}, Named{"\xc2\xa7", {}, {0xa7, 0}},
                    Named{"LaunchMediaPlayer", {}, {0x10a1, 0}}),
    [](const auto& c) { return "No" + std::to_string(c.index); });

struct Twin {
  const char* name;
  KeyEvent one, other;
  bool same = true;
};
class KeyTwins : public testing::TestWithParam<Twin> {};
TEST_P(KeyTwins, AreOneKeyOrTwo) {
  const auto& [name, one, other, same] = GetParam();
  EXPECT_EQ(canonical(one) == canonical(other), same);
  EXPECT_EQ(canonical(canonical(one)), canonical(one));
}
INSTANTIATE_TEST_SUITE_P(
    Table, KeyTwins,
    testing::Values(
        Twin{"EscapeOfQt3And4", {0x1000, 0}, {0x01000000, 0}}, Twin{"UpOfQt3And4", {0x1013, 0}, {0x01000013, 0}},
        Twin{"LaunchFOfQt3And4", {0x10b1, 0}, {0x010000b1, 0}},
        Twin{"Qt4sOwnKeyStays", {0x10b2, 0}, {0x010000b2, 0}, false}, Twin{"Shift", {0x41, 0x100}, {0x41, 0x02000000}},
        Twin{"Control", {0x41, 0x200}, {0x41, 0x04000000}}, Twin{"Alt", {0x41, 0x400}, {0x41, 0x08000000}},
        Twin{"Meta", {0x41, 0x800}, {0x41, 0x10000000}}, Twin{"Keypad", {0x1005, 0x4000}, {0x01000005, 0x20000000}},
        Twin{"Several", {0x1012, 0x300}, {0x01000012, 0x06000000}}, Twin{"ShiftOrNot", {0x41, 0x100}, {0x41, 0}, false},
        Twin{"KeypadOrNot", {0x37, 0x4000}, {0x37, 0}, false}, Twin{"CaseOfALetter", {'a', 0}, {'A', 0}},
        Twin{"CaseOfLatin1", {0xe9, 0}, {0xc9, 0}}, Twin{"SharpSHasOne", {0xdf, 0}, {0xff, 0}, false},
        Twin{"BacktabWithShift", {0x1001, 0x100}, {0x01000002, 0x02000000}},
        Twin{"StateBeforeAndAfterShift", {0x1020, 0}, {0x01000020, 0x02000000}},
        Twin{"ShiftWithAltIsNotShift", {0x1020, 0x400}, {0x1020, 0}, false},
        Twin{"MouseButtonsCount", {0x41, 1}, {0x41, 0}, false},
        Twin{"LettersAreNotArrows", {0x12, 0}, {0x1012, 0}, false}),
    [](const auto& c) { return std::string(c.param.name); });

struct Wrong {
  const char* name;
  const char* sentence;
};
class UnknownKeys : public testing::TestWithParam<Wrong> {};
TEST_P(UnknownKeys, SayWhatWasMeant) {
  const auto found = find_key(GetParam().name);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error(), HasSubstr(GetParam().sentence));
}
INSTANTIATE_TEST_SUITE_P(Table, UnknownKeys,
                         testing::Values(Wrong{"ArowUp", "did you mean \"ArrowUp\"?"},
                                         Wrong{"enter", "did you mean \"Enter\"?"},
                                         Wrong{"", "there is no key \"\"; keys have a browser's names"},
                                         Wrong{"F0", "there is no key \"F0\""}, Wrong{"F36", "no key \"F36\""},
                                         Wrong{"F1x", "no key"}, Wrong{"F99999999999", "no key"},
                                         Wrong{"\xe4", "no key"}, Wrong{"\xc2\x80", "no key"},
                                         Wrong{"\xe2\x82\xac", "no key"}, Wrong{"ab", "no key"}, Wrong{"\n", "no key"}),
                         [](const auto& c) { return "No" + std::to_string(c.index); });

TEST(KeyName, IsForPeople) {
  EXPECT_EQ(name_of({0x01000013, 0x02000000}), "shift+ArrowUp");
  EXPECT_EQ(name_of({'a', 0}), "A");
  EXPECT_EQ(name_of({' ', 0x200}), "control+\" \"");
  EXPECT_EQ(name_of({0x1002, 0x100}), "shift+Tab");
  EXPECT_EQ(name_of({0x1005, 0x4000}), "keypad+Enter");
  EXPECT_EQ(name_of({0x103a, 0}), "F11");
  EXPECT_EQ(name_of({0xffff, 0}), "key 65535 with state 0");
  EXPECT_EQ(name_of({0x41, 7}), "key 65 with state 7");
}

TEST(HeldKeys, AreNamedWithTheirModifiers) {
  EXPECT_EQ(find_held_key("ArrowUp").value(), (KeyEvent{0x1013, 0}));
  EXPECT_EQ(find_held_key("shift+ArrowUp").value(), (KeyEvent{0x1013, 0x100}));
  EXPECT_EQ(find_held_key("control+shift+a").value(), (KeyEvent{'A', 0x300}));
  EXPECT_EQ(find_held_key("+").value(), (KeyEvent{'+', 0}));
  EXPECT_EQ(find_held_key("shift++").value(), (KeyEvent{'+', 0x100}));
  EXPECT_EQ(find_held_key("Space").value(), find_key(" ").value());
  EXPECT_THAT(find_held_key("shft+a").error(), HasSubstr("there is no modifier \"shft\""));
  EXPECT_THAT(find_held_key("Spcae").error(), HasSubstr("did you mean \"Space\"?"));
}

// Whoever holds Shift and an arrow lets go of them in any order.
TEST(ReleasedKeys, HaveNoState) {
  EXPECT_EQ(canonical({0x1013, 0x100, true}), (KeyEvent{0x1013, 0, true}));
  EXPECT_EQ(canonical({0x1001, 0x100, true}), (KeyEvent{0x1001, 0, true})) << "Tab, which went down as Backtab";
  EXPECT_NE(canonical({0x1013, 0, true}), canonical({0x1013, 0}));
  EXPECT_EQ(name_of({0x1013, 0, true}), "release of ArrowUp");
}

}  // namespace peerd::key_codes_test
