#include "peerd/input/toml_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace peerd::toml_json_test {

TEST(TomlJson, KeepsValuesTypesAndOrder) {
  const toml::table table = toml::parse(
      "whole = 5\nnumber = 5.0\nyes = true\nword = \"w\"\nlist = [1, \"two\", [3.5]]\n[table]\ninner = -1\n");
  EXPECT_EQ(to_json(table).dump(),
            R"({"list":[1,"two",[3.5]],"number":5.0,"table":{"inner":-1},"whole":5,"word":"w","yes":true})");
}

TEST(TomlJson, ADateBecomesItsText) {
  const auto json = to_json(toml::parse("when = 2003-05-01"));
  ASSERT_TRUE(json["when"].is_string());
  EXPECT_NE(json["when"].get<std::string>().find("2003-05-01"), std::string::npos);
}

}  // namespace peerd::toml_json_test
