#include "core/formats/gltf/container.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "core/formats/draft/bytes.hpp"
#include "core/formats/gltf/property_kinds.hpp"
#include "core/vrml/diagnostics.hpp"

namespace peerd::formats::gltf {
namespace {

// Deep enough for any glTF; the library recurses this far.
constexpr std::size_t kMostNesting = 32;
constexpr std::size_t kLongestNumber = 32;  // of one that is whole and small enough, with what stands behind it
constexpr std::size_t kHeader_bytes = 12, kChunkHeader_bytes = 8;
// The library's memory for one value of each kind [bytes], estimated from above. An element is an object in a list at
// the top, such as a node. The library keeps all that a material has twice, and an extension value by value.
constexpr std::uint64_t kScalar = 48, kArray = 64, kOtherObject = 256, kElement = 640, kMaterial = 3072,
                        kExtensionValue = 256;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

// Passes once over a JSON text. It needs no grammar beyond brackets, strings, commas and the kinds of values: what is
// wrong elsewhere, the library says.
class Checker {
 public:
  Checker(std::string_view text, std::uint64_t most_bytes) : text_(text), bytes_(most_bytes) {}

  std::expected<CheckedJson, std::string> check() {
    for (at_ = 0; at_ < text_.size(); ++at_) {
      if (!why_.empty()) return std::unexpected(why_);
      step(text_[at_]);
    }
    if (why_.empty() && !open_.empty()) why_ = "the JSON ends in the middle";
    if (!why_.empty()) return std::unexpected(why_);
    out_.text += text_.substr(copied_);
    return std::move(out_);
  }

 private:
  // An object or a list that has begun.
  struct Open {
    char bracket;
    std::string_view key;     // of the property that has it as its value, or has the list in which it stands
    PropertyKind kind;        // of a list
    bool is_checked = true;   // whether its values must be of the kinds of their properties
    bool is_element = false;  // whether it stands in a list
    std::size_t commas = 0;   // of its own that were passed
    std::size_t begin = 0;    // of the text behind its bracket
    bool has_node = false;    // whether it has a property of that name
  };

  void step(char c) {
    const bool is_space = c == ' ' || c == '\t' || c == '\r' || c == '\n';
    const bool is_value = value_next_;
    if (value_next_ && !is_space && c != ']' && c != '}') {
      value_next_ = false;
      check_value();
    }
    switch (c) {
      case '{':
      case '[':
        begin(c);
        break;
      case '}':
      case ']':
        end(c);
        break;
      case ',':
        spend(kScalar);
        end_cut(at_);
        key_ = {};
        if (open_.empty()) break;
        ++open_.back().commas;
        value_next_ = open_.back().bracket == '[';
        break;
      case ':':
        begin_cut();
        value_next_ = true;
        break;
      case '"':
        pass_string(is_value);
        break;
      default:
        break;
    }
  }

  void begin(char bracket) {
    spend(bracket == '[' ? kArray : open_.size() != 2 ? kOtherObject : list_ == "materials" ? kMaterial : kElement);
    if (key_ == "extensions" && bracket == '{' && extensions_depth_ == 0) extensions_depth_ = open_.size() + 1;
    if (open_.size() == 1) list_ = key_;
    if (open_.size() == kMostNesting) why_ = "the JSON is nested more than " + std::to_string(kMostNesting) + " deep";
    Open one{bracket, key_, {}, true, false, 0, at_ + 1};
    if (!open_.empty()) {
      const Open& around = open_.back();
      one.is_element = around.bracket == '[';
      if (one.is_element) one.key = around.key;
      one.is_checked = around.is_checked && key_ != "extras" &&
                       (one.is_element || around.key != "extensions" || key_ == "KHR_lights_punctual");
      if (!one.is_element && one.is_checked) one.kind = kind_of_property(around.key, key_);
    }
    open_.push_back(one);
    value_next_ = bracket == '[';
    key_ = {};
  }

  void end(char bracket) {
    if (open_.empty() || open_.back().bracket != (bracket == '}' ? '{' : '[')) {
      why_ = "the brackets of the JSON do not match";
      return;
    }
    const Open& one = open_.back();
    if (one.kind.length != 0) {
      const bool is_empty =
          text_.substr(one.begin, at_ - one.begin).find_first_not_of(" \t\r\n") == std::string_view::npos;
      if (is_empty || one.commas + 1 != one.kind.length) {
        why_ = path_of_open() + "it must have " + std::to_string(one.kind.length) + " numbers";
      }
    }
    end_cut(at_);
    if (one.bracket == '{' && one.key == "target" && one.is_checked && !one.has_node && !cut_) add_no_node(one.begin);
    if (open_.size() == extensions_depth_) extensions_depth_ = 0;
    open_.pop_back();
    key_ = {};
    value_next_ = false;
  }

  // Gives the target of an animation's channel, whose text begins there, the node -1. A target without a node is good
  // glTF, for extensions, and the library refuses it.
  void add_no_node(std::size_t begin) {
    const bool is_empty = text_.substr(begin, at_ - begin).find_first_not_of(" \t\r\n") == std::string_view::npos;
    out_.text += text_.substr(copied_, at_ - copied_);
    out_.text += is_empty ? "\"node\":-1" : ",\"node\":-1";
    copied_ = at_;
  }

  // Refuses a value of another kind than its property has: the library would pass over it.
  void check_value() {
    if (open_.empty() || !open_.back().is_checked || is_in_extras()) return;
    const Open& around = open_.back();
    const bool is_element = around.bracket == '[';
    const ValueKind wanted = is_element ? around.kind.elements : kind_of_property(around.key, key_).value;
    if (is_of_kind(text_.substr(at_, kLongestNumber), wanted)) return;
    std::string path = path_of_open();
    path.resize(path.size() - 2);  // without ": "
    path += (path.empty() ? "" : "/") + (is_element ? std::to_string(around.commas) : shown(key_));
    why_ = path + ": it must be " + std::string(words_of(wanted));
  }

  // Returns a key as a message shows it: those of glTF as they are, and others, which the author makes up, in quotes.
  static std::string shown(std::string_view key) {
    const auto is_plain = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    };
    return key.size() <= 64 && std::ranges::all_of(key, is_plain) ? std::string(key) : vrml::quoted(key);
  }

  // Returns the path to the innermost of the open ones, such as "nodes/3/matrix: ".
  [[nodiscard]] std::string path_of_open() const {
    std::string path;
    for (std::size_t i = 1; i < open_.size(); ++i) {
      path +=
          (path.empty() ? "" : "/") + (open_[i].is_element ? std::to_string(open_[i - 1].commas) : shown(open_[i].key));
    }
    return path + ": ";
  }

  [[nodiscard]] bool is_in_extras() const { return cut_ && cut_->key == "extras"; }

  void spend(std::uint64_t bytes) {
    if (extensions_depth_ != 0) bytes = std::max(bytes, kExtensionValue);
    if (is_in_extras()) bytes = 0;  // nothing reads them
    if (bytes > bytes_) why_ = "its JSON asks for more than a file of this size may; the option expansion allows more";
    bytes_ -= std::min(bytes, bytes_);
  }

  void pass_string(bool is_value) {
    const std::size_t begin = at_ + 1;
    bool has_escapes = false;
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] != '\\') continue;
      has_escapes = true;
      ++at_;
    }
    if (at_ >= text_.size()) {
      why_ = "a string of the JSON has no end";
      return;
    }
    if (is_value || is_in_extras()) return;
    key_ = text_.substr(begin, at_ - begin);
    if (has_escapes) key_ = unescaped_.emplace_back(unescaped(key_));
    if (key_ == "node" && !open_.empty()) open_.back().has_node = true;
  }

  // Returns a key without its escapes. Every key of glTF is of ASCII; a character beyond it becomes a '?'.
  static std::string unescaped(std::string_view key) {
    constexpr std::string_view kEscaped = "bfnrt", kMeant = "\b\f\n\r\t";
    std::string out;
    for (std::size_t i = 0; i < key.size(); ++i) {
      if (key[i] != '\\') {
        out += key[i];
      } else if (key[++i] == 'u') {
        unsigned code = 0;
        const std::string_view digits = key.substr(i + 1, 4);
        std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
        out += code < 0x80 ? static_cast<char>(code) : '?';
        i += digits.size();
      } else {
        const std::size_t known = kEscaped.find(key[i]);
        out += known == std::string_view::npos ? key[i] : kMeant[known];
      }
    }
    return out;
  }

  // Begins to leave out the value behind a colon, where its key says so.
  void begin_cut() {
    const bool top = open_.size() == 1;
    if (cut_ || open_.empty()) return;
    if (key_ != "extras" && !(top && (key_ == "buffers" || key_ == "images" || key_ == "skins"))) return;
    cut_ = Cut{open_.size(), at_ + 1, key_};
    out_.text += text_.substr(copied_, at_ + 1 - copied_);
    out_.text += "null";
  }

  void end_cut(std::size_t end) {
    if (!cut_ || cut_->depth != open_.size()) return;
    const std::string_view value = text_.substr(cut_->begin, end - cut_->begin);
    if (cut_->key == "buffers") out_.buffers = value;
    if (cut_->key == "images") out_.images = value;
    if (cut_->key == "extras") ++out_.extras;
    copied_ = end;
    cut_.reset();
  }

  struct Cut {
    std::size_t depth = 0, begin = 0;
    std::string_view key;
  };

  std::string_view text_;
  std::uint64_t bytes_;               // left to spend
  std::string_view list_;             // the key at the top whose value is passed
  std::size_t extensions_depth_ = 0;  // of the open extensions object; 0: there is none
  std::size_t at_ = 0;
  std::size_t copied_ = 0;  // up to here the text is in the output, or left out
  std::vector<Open> open_;
  std::deque<std::string> unescaped_;  // the keys that have escapes
  std::string_view key_;               // of the value that comes next or is passed; empty for one of a list
  bool value_next_ = false;            // the next that is no white space begins a value
  std::optional<Cut> cut_;
  std::string why_;
  CheckedJson out_;
};

}  // namespace

std::expected<Container, std::string> chunks_of(std::string_view glb) {
  const auto number = [&](std::size_t at) { return little_endian<std::uint32_t>(glb.substr(at)); };
  if (glb.size() < kHeader_bytes + kChunkHeader_bytes) return std::unexpected("the GLB file ends in its header");
  if (number(4) != 2)
    return std::unexpected("this GLB file is of version " + std::to_string(number(4)) + "; 2 is read");
  if (number(8) > glb.size()) {
    return std::unexpected("this GLB file says that it has " + std::to_string(number(8)) + " bytes, and it has " +
                           std::to_string(glb.size()));
  }
  Container found;
  found.surplus_bytes = glb.size() - number(8);
  glb = glb.substr(0, number(8));
  for (std::size_t at = kHeader_bytes, chunk = 0; at < glb.size(); ++chunk) {
    if (glb.size() - at < kChunkHeader_bytes || glb.size() - at - kChunkHeader_bytes < number(at)) {
      return std::unexpected("a chunk of the GLB file ends behind the file");
    }
    const std::string_view data = glb.substr(at + kChunkHeader_bytes, number(at));
    const std::uint32_t type = number(at + 4);
    if (chunk == 0 && type != kJsonChunk) return std::unexpected("the first chunk of the GLB file is no JSON");
    if (chunk == 0) found.json = data;
    if (chunk == 1 && type == kBinaryChunk) found.binary = data;  // chunks of other types are to be passed over
    at += kChunkHeader_bytes + data.size();
  }
  return found;
}

std::expected<CheckedJson, std::string> checked_json(std::string_view text, std::uint64_t most_bytes) {
  return Checker(text, most_bytes).check();
}

}  // namespace peerd::formats::gltf
