#include "coin_answers.hpp"

#include <Inventor/SbViewportRegion.h>
#include <Inventor/SoDB.h>
#include <Inventor/SoInput.h>
#include <Inventor/SoPrimitiveVertex.h>
#include <Inventor/VRMLnodes/SoVRMLInterpolator.h>
#include <Inventor/VRMLnodes/SoVRMLShape.h>
#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/actions/SoGetBoundingBoxAction.h>
#include <Inventor/actions/SoSearchAction.h>
#include <Inventor/engines/SoEngineOutput.h>
#include <Inventor/fields/SoFields.h>
#include <Inventor/nodes/SoSeparator.h>

#include <memory>

#include "coin_reader.hpp"

namespace peerd::bench {
namespace {

using Shapes = std::vector<std::vector<Triangle>>;

struct Unref {
  void operator()(SoBase* node) const { node->unref(); }
};
using World = std::unique_ptr<SoSeparator, Unref>;

World read(std::string_view text) {
  SoInput input;
  input.setBuffer(text.data(), text.size());
  SoSeparator* const root = SoDB::readAll(&input);
  if (root != nullptr) root->ref();
  return World(root);
}

Vec3 to_vec3(const SbVec3f& v) { return {v[0], v[1], v[2]}; }

SoCallbackAction::Response begin_shape(void* shapes, SoCallbackAction*, const SoNode*) {
  static_cast<Shapes*>(shapes)->emplace_back();
  return SoCallbackAction::CONTINUE;
}

void add_triangle(void* shapes, SoCallbackAction* action, const SoPrimitiveVertex* a, const SoPrimitiveVertex* b,
                  const SoPrimitiveVertex* c) {
  Triangle& triangle = static_cast<Shapes*>(shapes)->back().emplace_back();
  for (std::size_t i = 0; i < 3; ++i) {
    SbVec3f p_world;
    action->getModelMatrix().multVecMatrix((i == 0 ? a : i == 1 ? b : c)->getPoint(), p_world);
    triangle[i] = to_vec3(p_world);
  }
}

// A field that is connected to value_changed, so that reading it makes the engine answer.
class Answer {
 public:
  explicit Answer(SoEngineOutput* output) {
    const SoType type = output->getConnectionType();
    field_.reset(static_cast<SoField*>(type.createInstance()));
    field_->connectFrom(output);
  }
  [[nodiscard]] std::vector<double> value() const {
    std::vector<double> out;
    if (const auto* scalar = as<SoSFFloat>()) {
      out = {scalar->getValue()};
    } else if (const auto* rotation = as<SoSFRotation>()) {
      const float* const q = rotation->getValue().getValue();
      out = {q[0], q[1], q[2], q[3]};
    } else if (const auto* color = as<SoSFColor>()) {
      const SbColor rgb = color->getValue();
      out = {rgb[0], rgb[1], rgb[2]};
    } else if (const auto* vector = as<SoSFVec3f>()) {
      const SbVec3f v = vector->getValue();
      out = {v[0], v[1], v[2]};
    } else if (const auto* vectors = as<SoMFVec3f>()) {
      const SbVec3f* const v = vectors->getValues(0);  // also evaluates
      for (int i = 0; i < vectors->getNum(); ++i) out.insert(out.end(), {v[i][0], v[i][1], v[i][2]});
    }
    return out;
  }

 private:
  template <class T>
  [[nodiscard]] const T* as() const {
    return field_->isOfType(T::getClassTypeId()) ? static_cast<const T*>(field_.get()) : nullptr;
  }
  std::unique_ptr<SoField> field_;
};

}  // namespace

std::optional<Shapes> shapes_of_coin(std::string_view text) {
  const std::size_t errors = coin_errors();
  const World world = read(text);
  if (world == nullptr) return std::nullopt;
  Shapes shapes;
  SoCallbackAction action;
  action.addPreCallback(SoVRMLShape::getClassTypeId(), begin_shape, &shapes);
  action.addTriangleCallback(SoNode::getClassTypeId(), add_triangle, &shapes);
  action.apply(world.get());
  if (coin_errors() != errors) return std::nullopt;
  return shapes;
}

std::optional<WorldBox> box_of_coin(std::string_view text) {
  const std::size_t errors = coin_errors();
  const World world = read(text);
  if (world == nullptr) return std::nullopt;
  SoGetBoundingBoxAction action(SbViewportRegion(100, 100));
  action.apply(world.get());
  const SbBox3f box = action.getBoundingBox();
  if (coin_errors() != errors || box.isEmpty()) return std::nullopt;
  return WorldBox{to_vec3(box.getMin()), to_vec3(box.getMax())};
}

std::optional<std::vector<std::vector<double>>> values_of_coin(std::string_view text,
                                                               std::span<const float> fractions) {
  const std::size_t errors = coin_errors();
  const World world = read(text);
  if (world == nullptr) return std::nullopt;
  SoSearchAction search;
  search.setType(SoVRMLInterpolator::getClassTypeId());
  search.apply(world.get());
  if (search.getPath() == nullptr) return std::nullopt;
  auto* const interpolator = static_cast<SoVRMLInterpolator*>(search.getPath()->getTail());
  const Answer answer(interpolator->getOutput("value_changed"));
  std::vector<std::vector<double>> values;
  for (const float fraction : fractions) {
    interpolator->set_fraction.setValue(fraction);
    values.push_back(answer.value());
  }
  if (coin_errors() != errors) return std::nullopt;
  return values;
}

}  // namespace peerd::bench
