#include "core/writer/text_writer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>

namespace peerd::vrml {
namespace {

// The writer uses the fewest digits that read back to the same bits; std::to_chars tells -0 from 0.
template <class T>
void append_number(std::string& out, T value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  out.append(digits.data(), end);
}

void append_string(std::string& out, std::string_view value) {
  out += '"';
  for (const char c : value) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  out += '"';
}

}  // namespace

std::string string_text(std::string_view value) {
  std::string out;
  append_string(out, value);
  return out;
}

void TextWriter::number(float value) { append_number(out_, value); }
void TextWriter::number(double value) { append_number(out_, value); }
void TextWriter::number(std::int32_t value) { append_number(out_, value); }

template <class AddOne, class Closes>
void TextWriter::list(std::size_t count, AddOne add_one, Closes closes, std::string_view between_groups) {
  if (count == 0) {
    out_ += "[ ]";
    return end_line();
  }
  // A list is written on one line if it fits. A list that does not is found out within the width of a line.
  const std::size_t begin = out_.size();
  const std::size_t line_begin = out_.rfind('\n') + 1;
  out_ += "[ ";
  std::size_t i = 0;
  for (; i < count && out_.size() - line_begin < kWidth; ++i) {
    add_one(i);
    out_ += i + 1 == count ? std::string_view(" ") : closes(i) ? between_groups : std::string_view(" ");
  }
  if (i == count && out_.size() - line_begin < kWidth) {
    out_ += ']';
    return end_line();
  }
  out_.resize(begin);
  open("[");
  const std::size_t indent = 2 * depth_;
  std::size_t this_line = out_.size(), group = out_.size();
  out_.append(indent, ' ');
  bool first_in_line = true;
  for (i = 0; i < count; ++i) {
    if (out_.size() == this_line + indent) group = out_.size();
    add_one(i);
    if (out_.size() - this_line > kWidth && !first_in_line) {
      // The group begins the next line; out_[group - 1] is the blank before it.
      out_[group - 1] = '\n';
      this_line = group;
      out_.insert(group, indent, ' ');
      group += indent;
    }
    if (i + 1 == count) break;
    if (closes(i)) {
      out_ += between_groups;
      group = out_.size();
      first_in_line = false;
    } else if (out_.size() - this_line > kWidth) {
      // A single group can be longer than a line.
      end_line();
      this_line = out_.size();
      out_.append(indent, ' ');
      group = out_.size();
      first_in_line = true;
    } else {
      out_ += ' ';
    }
  }
  end_line();
  close("]");
}

void TextWriter::strings(std::span<const std::string> texts) {
  list(
      texts.size(), [&](std::size_t i) { append_string(out_, texts[i]); }, [](std::size_t) { return true; }, " ");
}

// The bytes of a pixel are written in hexadecimal, one for each component; a row of pixels begins a line.
void TextWriter::image(std::span<const std::int32_t> image) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0) out_ += ' ';
    number(image[i]);
  }
  const auto digits = 2 * static_cast<std::size_t>(image[2]);
  const auto width = static_cast<std::size_t>(image[0]);
  ++depth_;
  std::size_t column = kWidth;
  for (std::size_t i = 3; i < image.size(); ++i) {
    if ((i - 3) % width == 0 || column + 3 + digits > kWidth) {
      end_line();
      out_.append(2 * depth_, ' ');
      column = 2 * depth_;
    } else {
      out_ += ' ';
    }
    std::array<char, 8> text{};
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), static_cast<std::uint32_t>(image[i]), 16).ptr;
    const auto size = static_cast<std::size_t>(end - text.data());
    out_ += "0x";
    if (size < digits) out_.append(digits - size, '0');
    out_.append(text.data(), end);
    column += 3 + std::max(size, digits);
  }
  --depth_;
  end_line();
}

void TextWriter::value(const Field& field) {
  using enum FieldType;
  const FieldType type = field.spec->type;
  const auto always = [](std::size_t) { return true; };
  const auto single = [&](auto add_one) {
    add_one();
    end_line();
  };
  switch (type) {
    case kSFBool:
      return single([&] { out_ += field.as<bool>()[0] ? "TRUE" : "FALSE"; });
    case kSFInt32:
      return single([&] { number(field.as<std::int32_t>()[0]); });
    case kSFTime:
      return single([&] { number(field.as<double>()[0]); });
    case kSFString:
      return single([&] { append_string(out_, field.as<std::string_view>()[0]); });
    case kSFImage:
      return image(field.as<std::int32_t>());
    case kMFTime:
      return list(
          field.count, [&](std::size_t i) { number(field.as<double>()[i]); }, always, " ");
    case kMFString:
      return list(
          field.count, [&](std::size_t i) { append_string(out_, field.as<std::string_view>()[i]); }, always, " ");
    case kMFInt32: {
      // Polygons and lines stay together; a list without any -1 is single numbers.
      const auto numbers = field.as<std::int32_t>();
      const bool polygons = std::ranges::find(numbers, -1) != numbers.end();
      return list(
          numbers.size(), [&](std::size_t i) { number(numbers[i]); },
          [&](std::size_t i) { return !polygons || numbers[i] == -1; }, polygons ? ", " : " ");
    }
    default:
      break;
  }
  const auto floats = field.as<float>();
  const auto width = static_cast<std::size_t>(float_count(type));
  assert(width > 0 && "nodes are the writer's");
  if (is_list(type)) {
    return list(
        floats.size(), [&](std::size_t i) { number(floats[i]); }, [&](std::size_t i) { return (i + 1) % width == 0; },
        width > 1 ? ", " : " ");
  }
  for (std::size_t i = 0; i < width; ++i) {
    if (i > 0) out_ += ' ';
    number(floats[i]);
  }
  end_line();
}

}  // namespace peerd::vrml
