// These tests are about Script (ISO/IEC 14772-1:1997, 4.12 and 6.40).
#include <gmock/gmock.h>

#include "core/vrml/default_values.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::vrml::script_parser_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Script, HasFieldsOfItsOwn) {
  const std::string body = R"(
    DEF N Transform { }
    DEF S Script {
      eventIn SFBool start
      field SFFloat speed 2.5
      url [ "a.js" "javascript: function start(v) { moved = '}'; } # \"quoted\"" ]
      eventOut SFVec3f moved
      field MFNode nodes [ USE N Group { } ]
      directOutput TRUE
      mustEvaluate TRUE
    }
    ROUTE S.moved TO N.translation)";
  const Scene scene = scene_of(body);
  const Node& script = scene.document->nodes[nodes_of_type(*scene.document, "Script").at(0)];
  EXPECT_EQ(script.type->fields.size(), 3u + 4u);
  EXPECT_EQ(script.find("speed")->as<float>()[0], 2.5f);
  EXPECT_EQ(script.find("nodes")->count, 2u);
  EXPECT_EQ(script.find("url")->as<std::string_view>()[1],
            "javascript: function start(v) { moved = '}'; } # \"quoted\"");
  EXPECT_TRUE(value_of(script, "directOutput").as<bool>()[0]);
  EXPECT_EQ(script.find("start"), nullptr);
  EXPECT_EQ(document_violation(*scene.document), "");
  EXPECT_THAT(routes_of(*scene.document), ElementsAre("S.moved > N.translation"));
  EXPECT_THAT(problems_of(body), ElementsAre("warning 4:5: Scripts are kept and not run; this is the first one"));
}

// Nodes in a Script's fields are no part of the hierarchy (4.4.4).
TEST(Script, IsNoPartOfTheScene) {
  EXPECT_THAT(paths_of(scene_of("Group { children [ Script { field SFNode n Shape { } } Shape { } ] }")),
              ElementsAre("0", "0/1"));
}

// The nodes that the fields of a Script name need not be in it (4.12.9.2), so they may be the Script itself or nodes
// around it.
TEST(Script, MayHoldItself) {
  const Scene scene = scene_of("DEF S Script { field SFNode self USE S field MFNode all [ USE S Group { } USE S ] }");
  const std::uint32_t s = nodes_of_type(*scene.document, "Script").at(0);
  const Node& script = scene.document->nodes[s];
  EXPECT_EQ(script.find("self")->as<NodeRef>()[0].index, s);
  EXPECT_EQ(script.find("all")->as<NodeRef>()[0].index, s);
  EXPECT_LT(script.find("all")->as<NodeRef>()[1].index, s);
  EXPECT_EQ(script.find("all")->as<NodeRef>()[2].index, s);
  EXPECT_EQ(document_violation(*scene.document), "");
}

TEST(Script, MayHoldWhatIsAroundIt) {
  const Scene scene =
      scene_of("DEF A Transform { children DEF B Group { children Script { field MFNode n [ USE B USE A ] } } }");
  const Document& document = *scene.document;
  const auto n = document.nodes[nodes_of_type(document, "Script").at(0)].find("n")->as<NodeRef>();
  EXPECT_EQ(n[0].index, nodes_of_type(document, "Group").at(0));
  EXPECT_EQ(n[1].index, nodes_of_type(document, "Transform").at(0));
  EXPECT_EQ(document_violation(document), "");
}

TEST(Script, MayHoldScriptsThatHoldWhatIsAroundThem) {
  for (const char* inner : {"Script { field SFNode m USE A }", "Script { field SFBool m TRUE }",
                            "Script { field MFNode m [ USE A USE A ] }"}) {
    const Scene scene =
        scene_of(std::string("DEF A Group { children Script { field MFNode n [ USE A ") + inner + " USE A ] } }");
    EXPECT_EQ(document_violation(*scene.document), "") << inner;
    const std::uint32_t a = nodes_of_type(*scene.document, "Group").at(0);
    const Node& outer = scene.document->nodes[nodes_of_type(*scene.document, "Script").at(1)];
    EXPECT_EQ(outer.find("n")->as<NodeRef>()[0].index, a) << inner;
    EXPECT_EQ(outer.find("n")->as<NodeRef>()[2].index, a) << inner;
  }
}

TEST(Script, MayHoldTheInstanceAroundIt) {
  const Scene scene = scene_of(
      "PROTO Bag [ field MFNode kids [ ] ] { Transform { children IS kids } }\n"
      "DEF B Bag { kids Script { field SFNode n USE B } }");
  const Document& document = *scene.document;
  EXPECT_EQ(document.nodes[nodes_of_type(document, "Script").at(0)].find("n")->as<NodeRef>()[0].index,
            nodes_of_type(document, "Transform").at(0));
  EXPECT_EQ(document_violation(document), "");
}

TEST(Script, OfALostNodeHoldsNothing) {
  EXPECT_THAT(errors_of("DEF A Group { x 1 children DEF B Shpae { } } DEF C Transform { children Script { field MFNode "
                        "n [ USE C USE B ] } }")
                  .size(),
              2u);
}

TEST(Script, MayHoldItselfInAProto) {
  const Scene scene = scene_of(
      "PROTO P [ ] { DEF G Group { children [ Shape { } DEF S Script { field SFNode self USE S field SFNode up USE G } "
      "] } } P { } P { }");
  const auto groups = nodes_of_type(*scene.document, "Group");
  const auto scripts = nodes_of_type(*scene.document, "Script");
  ASSERT_EQ(scripts.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(scene.document->nodes[scripts[i]].find("self")->as<NodeRef>()[0].index, scripts[i]);
    EXPECT_EQ(scene.document->nodes[scripts[i]].find("up")->as<NodeRef>()[0].index, groups[i]);
  }
  EXPECT_EQ(document_violation(*scene.document), "");
}

// 4.8.3: IS may stand wherever fields may.
TEST(Script, TakesItsFieldsAndEventsFromAProto) {
  const Scene scene = scene_of(R"(
    PROTO P [ field SFFloat f 3 eventIn SFBool in eventOut SFBool out field MFString code "a.js" field SFNode n NULL ] {
      DEF S Script { field SFFloat mine IS f eventIn SFBool go IS in eventOut SFBool gone IS out url IS code
                     field SFNode node IS n field SFFloat after 7 } }
    DEF A P { } DEF B P { f 4 code [ "b.js" "c.js" ] n Group { } }
    ROUTE A.out TO B.in)");
  const auto scripts = nodes_of_type(*scene.document, "Script");
  ASSERT_EQ(scripts.size(), 2u);
  const auto get = [&](int i, const char* field) -> const Field& {
    return *scene.document->nodes[scripts[i]].find(field);
  };
  EXPECT_EQ(get(0, "mine").as<float>()[0], 3);
  EXPECT_EQ(get(1, "mine").as<float>()[0], 4);
  EXPECT_EQ(get(0, "url").count, 1u);
  EXPECT_EQ(get(1, "url").count, 2u);
  EXPECT_EQ(get(1, "after").as<float>()[0], 7);
  EXPECT_EQ(get(0, "node").count, 0u);
  EXPECT_TRUE(get(1, "node").as<NodeRef>()[0].is_node());
  EXPECT_EQ(document_violation(*scene.document), "");
  EXPECT_THAT(routes_of(*scene.document), ElementsAre("A.gone > B.go"));
}

class BadScript : public testing::TestWithParam<BadCase> {};
TEST_P(BadScript, IsReportedWhereItIs) { EXPECT_EQ(errors_of(GetParam().body), GetParam().problems); }
INSTANTIATE_TEST_SUITE_P(
    Table, BadScript,
    testing::Values(
        BadCase{"ExposedField",
                "Script {\n exposedField SFBool a TRUE\n field SFBool b x }",  // 6.40: none
                {"3:2: a Script declares fields, eventIns and eventOuts, no exposedFields",
                 "4:17: 'b' (SFBool) wants TRUE or FALSE, found 'x'", "4:17: Script has no field 'x'"}},
        BadCase{"Twice", "Script { field SFBool a TRUE\n eventIn SFFloat a }", {"3:18: this Script has 'a' already"}},
        BadCase{"AFieldOfEveryScript", "Script { field MFString url \"a\" }", {"2:25: this Script has 'url' already"}},
        BadCase{"NoType",
                "Script { eventIn go }\nShpae { }",
                {"2:18: expected a field type, found 'go'", "3:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{
            "NoName",
            "Script { eventIn SFBool }\nShpae { }",
            {"2:25: expected the name of a field, found '}'", "3:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"NoValue",
                "Script { field SFFloat a field SFFloat b 1 }",
                {"2:26: 'a' (SFFloat) wants a number, found 'field'"}},
        BadCase{"UndeclaredField",
                "Script { field SFFloat speed 1 sped 2 }",
                {"2:32: Script has no field 'sped', did you mean 'speed'?"}},
        BadCase{"IsOutsideOfProtos", "Script { field SFFloat a IS b }", {"2:26: IS belongs inside a PROTO"}},
        BadCase{"IsOfAnotherType",
                "PROTO P [ field SFInt32 b 1 ] { Script { field SFFloat a IS b } }",
                {"2:56: 'a' is SFFloat and cannot be 'b', which is SFInt32"}},
        BadCase{"IsOfAnotherAccess",
                "PROTO P [ eventOut SFFloat b ] { Script { eventIn SFFloat a IS b } }",
                {"2:59: the eventIn 'a' cannot be the eventOut 'b'"}},
        BadCase{"UseOfItselfInAnotherNode",
                "DEF S Script { field SFNode n Group { children USE S } }",
                {"2:52: USE of 'S' inside that node itself: a node cannot contain itself"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

// A name of annex A.3's list is no name.
TEST(Script, RefusesKeywordsAsNames) {
  EXPECT_THAT(errors_of("Script { field SFBool TRUE FALSE }").size(), 1u);
  EXPECT_THAT(errors_of("Script { eventIn SFBool eventOut SFBool b }").size(), 1u);
}

// Every field counts, however many there are.
TEST(Script, KeepsSeventyThousandFields) {
  std::string body = "Script {";
  for (int i = 0; i < 70'000; ++i) body += " field SFInt32 f" + std::to_string(i) + " 1";
  const ReadResult result = read_body(body + " }");
  if (!result.scene) return;  // refused, and said so
  EXPECT_EQ(result.scene->document->nodes.at(0).given().size(), 70'000u);
}

}  // namespace peerd::vrml::script_parser_test
