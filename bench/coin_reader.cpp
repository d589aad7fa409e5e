#include "coin_reader.hpp"

#include <Inventor/SoDB.h>
#include <Inventor/SoInput.h>
#include <Inventor/SoPrimitiveVertex.h>
#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/errors/SoDebugError.h>
#include <Inventor/errors/SoReadError.h>
#include <Inventor/nodes/SoSeparator.h>

namespace peerd::bench {
namespace {

std::size_t errors = 0;
void count_error(const SoError*, void*) { ++errors; }

void count_triangle(void* count, SoCallbackAction*, const SoPrimitiveVertex*, const SoPrimitiveVertex*,
                    const SoPrimitiveVertex*) {
  ++*static_cast<std::uint64_t*>(count);
}

SoSeparator* read(std::string_view text) {
  SoInput input;
  input.setBuffer(text.data(), text.size());
  SoSeparator* const root = SoDB::readAll(&input);
  if (root != nullptr) root->ref();
  return root;
}

}  // namespace

void start_coin() {
  SoDB::init();
  SoInput::clearDirectories();
  SoError::setHandlerCallback(count_error, nullptr);  // else printing them is part of its time
  SoReadError::setHandlerCallback(count_error, nullptr);
  SoDebugError::setHandlerCallback(count_error, nullptr);
}

std::size_t coin_errors() { return errors; }

bool read_with_coin(std::string_view text) {
  SoSeparator* const root = read(text);
  if (root == nullptr) return false;
  root->unref();
  return true;
}

std::optional<std::uint64_t> triangles_of_coin(std::string_view text) {
  const std::size_t before = errors;
  SoSeparator* const root = read(text);
  if (root == nullptr) return std::nullopt;
  std::uint64_t triangles = 0;
  const std::size_t read_errors = errors - before;
  SoCallbackAction action;
  action.addTriangleCallback(SoNode::getClassTypeId(), count_triangle, &triangles);
  action.apply(root);
  root->unref();
  if (read_errors > 0) return std::nullopt;
  return triangles;
}

}  // namespace peerd::bench
