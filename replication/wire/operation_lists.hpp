#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The lists by which peers exchange operations, as bytes: varints, one entry behind the other. take_..() trusts
// nothing: it returns false for bytes that packed() does not make.

// The end of the longest log: 2^40 bytes.
inline constexpr std::uint64_t kLogMax_bytes = std::uint64_t{1} << 40;
// The numbers of entries of one message; what follows from the sizes of datagrams alone is more.
inline constexpr std::size_t kLogLengthsMax = 128, kOperationPartsMax = 64, kOperationRangesMax = 32;

// Lengths of logs, whose authors ascend; each is > 0.
[[nodiscard]] std::string packed(std::span<const LogLength> logs);
[[nodiscard]] bool take_logs(std::string_view bytes, std::vector<LogLength>& logs);

// Parts of logs, each with a byte at least.
[[nodiscard]] std::string packed(std::span<const OperationPart> parts);
[[nodiscard]] bool take_parts(std::string_view bytes, std::vector<OperationPart>& parts);

// Ranges that are asked for, each of a byte at least.
[[nodiscard]] std::string packed(std::span<const OperationRange> ranges);
[[nodiscard]] bool take_ranges(std::string_view bytes, std::vector<OperationRange>& ranges);

// The bytes that a list adds to a datagram are those of its entries, and kOperationListHeader_bytes where there are
// any.
inline constexpr std::size_t kOperationListHeader_bytes = 3;
// An entry of the list of lengths behind one of the author `before` (kNoAuthor: the first).
[[nodiscard]] std::size_t encoded_size_bytes(AuthorId before, const LogLength& log);
// A part besides its bytes, and a range.
[[nodiscard]] std::size_t part_header_bytes(const OperationRange& of_part);
[[nodiscard]] std::size_t encoded_size_bytes(const OperationRange& range);

// The bytes that all entries of one list of parts may have, and those of one list of ranges, in a datagram that has
// nothing else: the header of a datagram is at most 20 bytes.
inline constexpr std::size_t kOperationsMax_bytes = 1106;

}  // namespace peerd::replication
