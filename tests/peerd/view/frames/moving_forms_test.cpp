#include "peerd/view/frames/moving_forms.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::moving_forms_test {

using peerd::testing_support::scene_of;
using testing::ElementsAre;
using testing::IsEmpty;

MovingForms forms_of(const Scene& scene) {
  const PredefinedMotion motion(scene);
  return moving_forms(scene, motion, Carriers(scene, motion, {}));
}

TEST(MovingForms, AreDrivenCoordinatesAndWhatIsBelowADrivenScale) {
  const Scene scene = scene_of(R"(
DEF T TimeSensor { loop TRUE }
DEF WAVE CoordinateInterpolator { key [0 1] keyValue [0 0 0, 1 0 0, 0 1 0, 0 0 1, 1 0 0, 0 1 0] }
DEF GROW PositionInterpolator { key [0 1] keyValue [1 1 1, 2 2 2] }
DEF STANDS Shape { geometry Box { } }
DEF FLAG Shape { geometry IndexedFaceSet { coord DEF C Coordinate { point [0 0 0, 1 0 0, 0 1 0] } coordIndex [0 1 2] } }
DEF X Transform { children [ DEF A Shape { geometry Box { } } DEF B Shape { } Transform { children DEF D Shape { geometry Cone { } } } ] }
ROUTE T.fraction_changed TO WAVE.set_fraction ROUTE WAVE.value_changed TO C.point
ROUTE T.fraction_changed TO GROW.set_fraction ROUTE GROW.value_changed TO X.scale)");
  const MovingForms forms = forms_of(scene);
  EXPECT_THAT(forms.geometries, ElementsAre(scene.at(*scene.find("FLAG")).geometry));
  EXPECT_THAT(forms.shapes, ElementsAre(*scene.find("A"), *scene.find("D")))
      << "a Shape without a geometry has no form";
  EXPECT_EQ(forms.of_shape(*scene.find("D")), 1u);
  EXPECT_EQ(forms.of_shape(*scene.find("FLAG")), std::nullopt);
  EXPECT_EQ(forms.of_geometry(scene.at(*scene.find("FLAG")).geometry), 0u);
  EXPECT_EQ(forms.of_geometry(scene.at(*scene.find("STANDS")).geometry), std::nullopt);
}

TEST(MovingForms, AreNoneWhereAllIsRigid) {
  const MovingForms forms = forms_of(scene_of("Transform { children Shape { geometry Box { } } }"));
  EXPECT_THAT(forms.geometries, IsEmpty());
  EXPECT_THAT(forms.shapes, IsEmpty());
}

}  // namespace peerd::view::moving_forms_test
