#include "core/parser/parse_context.hpp"

#include <algorithm>
#include <memory>

#include "core/vrml/gzip.hpp"
#include "core/vrml/lexer.hpp"
#include "core/x3d/xml_reader.hpp"

namespace peerd::vrml {

std::expected<OpenText, UnopenedText> open_text(ParseContext& context, Source source) {
  const ReadLimits& limits = context.options.limits;
  const std::uint64_t left = limits.text_bytes - std::min(context.text_bytes, limits.text_bytes);
  std::expected<Header, HeaderError> header = std::unexpected(HeaderError{});
  if (is_gzip(source.text)) {
    const std::uint64_t may_grow_to = limits.unpacked_bytes(source.text.size());
    std::expected<std::string, std::string> unpacked =
        gunzip(source.text, std::min(left, may_grow_to), may_grow_to < left ? ReadLimits::kRaised : "");
    if (unpacked) {
      source.owned = std::make_shared<const std::string>(std::move(*unpacked));
      source.text = *source.owned;
      header = read_header(source.text);
    } else {
      header = std::unexpected(HeaderError{unpacked.error()});
    }
  } else if (source.text.size() > left) {
    header = std::unexpected(
        HeaderError{"it is larger than " + std::to_string(left) + " bytes, more than this reader takes"});
    source.text = {};
  } else {
    header = read_header(source.text);
  }
  context.text_bytes += source.text.size();
  const std::optional<Position> begin = context.problems.open(std::move(source));
  if (!header && header.error().is_fault && begin && context.problems.lenient()) {
    context.problems.fault(*begin, header.error().why, "the text is read as VRML97");
    return OpenText{*begin, header.error().begin};
  }
  if (!header) return std::unexpected(UnopenedText{header.error().why, header.error().is_fault});
  if (!begin) {
    return std::unexpected(UnopenedText{"its files together are larger than 4 GiB, more than this reader takes"});
  }
  if (!header->remark.empty()) context.problems.warning(*begin, std::string(header->remark));
  OpenText text{*begin, header->end, header->dialect};
  context.has_x3d = context.has_x3d || text.dialect != Dialect::kVrml97;
  if (text.dialect == Dialect::kX3dXml) {
    text.classic = std::make_shared<const ClassicText>(classic_of_xml(*begin, context.problems, limits));
    text.body = 0;
  }
  return text;
}

}  // namespace peerd::vrml
