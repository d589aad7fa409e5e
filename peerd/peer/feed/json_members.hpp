#pragma once
#include <cstdint>
#include <expected>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace peerd::feed {

// The version of the control protocol and of pose messages (docs/reference/control-protocol.md).
inline constexpr int kMessageVersion = 1;

// Parses one line of hostile input as a JSON object in which no object, nested ones included, names a member twice. The
// error is one sentence for the sender.
[[nodiscard]] std::expected<nlohmann::json, std::string> parse_json_object(std::string_view line);

// Reads the members of one JSON object, each at most once. The first error is kept and later ones are ignored, as in
// the reader of configurations; a member that no caller has asked for is an error, too. The object must outlive this.
class JsonMembers {
 public:
  explicit JsonMembers(const nlohmann::json& object) : object_(object) {}

  [[nodiscard]] bool has(const char* name) const { return object_.contains(name); }
  std::optional<std::string> text(const char* name);
  // A list of strings; none where the member is missing or wrong.
  std::optional<std::vector<std::string>> texts(const char* name);
  bool flag(const char* name, bool otherwise = false);
  // A whole number from `min` to `max`; `otherwise` where the member is missing or wrong.
  std::int64_t whole(const char* name, std::int64_t otherwise, std::int64_t min, std::int64_t max);
  std::optional<double> number(const char* name);
  // A list of exactly `Size` numbers; 3 and 4 are instantiated.
  template <int Size>
  std::optional<Eigen::Matrix<double, Size, 1>> numbers(const char* name);
  // An object; null where the member is missing or wrong.
  const nlohmann::json* object(const char* name);
  // A list of objects; empty where the member is missing.
  std::vector<const nlohmann::json*> objects(const char* name);
  // The value; an error where there is none.
  template <class T>
  T required(std::optional<T> value, const char* name) {
    if (!value) fail(name, "is missing" + stands_in_place_of(name));
    return value ? std::move(*value) : T();
  }
  // Reads "v". The error, one sentence, names a version other than kMessageVersion.
  std::expected<void, std::string> check_version();

  void fail(const std::string& name, const std::string& what);
  // Checks that all members have been read. Returns the first error as a sentence; empty where nothing is wrong.
  [[nodiscard]] std::string finish();

 private:
  const nlohmann::json* find(const char* name);
  // The end of a sentence that names a member which was probably meant to be `name`; empty where none was.
  [[nodiscard]] std::string stands_in_place_of(const char* name) const;

  const nlohmann::json& object_;
  std::set<std::string> known_;
  std::string error_;
};

}  // namespace peerd::feed
