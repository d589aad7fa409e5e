#pragma once
#include <gmock/gmock.h>

#include <expected>
#include <optional>
#include <source_location>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

// A test takes the value of a call that must succeed, or the error of a call that must fail. If the call does the
// opposite, an exception ends the test with the place of the call and the error's words.
namespace peerd {

template <class Error>
std::string words_of(const Error& error) {
  if constexpr (std::is_constructible_v<std::string, const Error&>) {
    return std::string(error);
  } else if constexpr (requires { std::string(error.text); }) {
    return error.text;
  } else if constexpr (requires { error.sentence; }) {
    return error.sentence;
  } else {
    return testing::PrintToString(error);
  }
}

[[noreturn]] inline void end_test(const std::string& why, const std::source_location& where) {
  throw std::runtime_error(std::string(where.file_name()) + ":" + std::to_string(where.line()) + ": " + why);
}

template <class T, class Error>
T must(std::expected<T, Error> result, const std::source_location& where = std::source_location::current()) {
  if (!result) end_test(words_of(result.error()), where);
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

template <class T>
T must(std::optional<T> value, const std::source_location& where = std::source_location::current()) {
  if (!value) end_test("there is no value", where);
  return *std::move(value);
}

// The element of a list that has just one.
template <class List>
auto only(const List& list, const std::source_location& where = std::source_location::current()) {
  if (list.size() != 1) end_test("there are " + std::to_string(list.size()), where);
  return *list.begin();
}

template <class T, class Error>
Error error_of(const std::expected<T, Error>& result,
               const std::source_location& where = std::source_location::current()) {
  if (result) end_test("it succeeded", where);
  return result.error();
}

// An error of that exit code or kind whose words match.
MATCHER_P2(IsError, code, words, "") {
  if constexpr (requires { arg.exit_code; }) {
    if (arg.exit_code != code) return false;
  } else {
    if (arg.kind != code) return false;
  }
  return testing::ExplainMatchResult(words, words_of(arg), result_listener);
}

}  // namespace peerd
