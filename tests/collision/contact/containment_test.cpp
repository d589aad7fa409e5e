#include "collision/contact/containment.hpp"

#include <gtest/gtest.h>

#include <string>

#include "core/scene/reader.hpp"
#include "tests/collision/shapes.hpp"

namespace peerd::collision::containment_test {

using test::moving;

Body body_of(const std::string& geometry) {
  const Scene scene =
      read_world("#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry " + geometry + " } }\n").scene.value();
  return make_body(scene, scene.find("A").value());
}

const char* const kBox = "Box { size 4 2 4 }";
// An L from above, 1 m high; its notch is at +x, +y.
const char* const kPrism =
    "IndexedFaceSet { convex FALSE coord Coordinate { point [-1 -1 -1, 1 -1 -1, 1 0 -1, 0 0 -1, 0 1 -1, -1 1 -1, "
    "-1 -1 1, 1 -1 1, 1 0 1, 0 0 1, 0 1 1, -1 1 1] } coordIndex [5 4 3 2 1 0 -1, 6 7 8 9 10 11 -1, 0 1 7 6 -1, "
    "1 2 8 7 -1, 2 3 9 8 -1, 3 4 10 9 -1, 4 5 11 10 -1, 5 0 6 11 -1] }";

TEST(Containment, OfPrimitivesWithAllTheirSidesIsClosed) {
  for (const char* const geometry : {kBox, kPrism, "Sphere { }", "Cone { }", "Cylinder { }"}) {
    EXPECT_TRUE(is_closed(body_of(geometry).surface->soup())) << geometry;
  }
  for (const char* const geometry :
       {"Cone { bottom FALSE }", "Cylinder { top FALSE }",
        "IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } coordIndex [0 1 2 -1] }"}) {
    EXPECT_FALSE(is_closed(body_of(geometry).surface->soup())) << geometry;
  }
}

TEST(Containment, TheWindingNumberIsOneInsideAndNoneOutside) {
  const Body prism = body_of(kPrism);
  for (const Vec3& inside : {Vec3(-0.5, -0.5, 0), Vec3(0.9, -0.1, 0.9), Vec3(-0.01, 0.99, -0.99)}) {
    EXPECT_NEAR(winding_number(prism.surface->soup(), inside), 1.0, 1e-12);
  }
  for (const Vec3& outside : {Vec3(0.5, 0.5, 0), Vec3(0.01, 0.01, 0), Vec3(9, 0, 0)}) {
    EXPECT_NEAR(winding_number(prism.surface->soup(), outside), 0.0, 1e-12);
  }
}

TEST(Containment, IsOfTheWholeBody) {
  const Body ball = body_of("Sphere { radius 0.25 }"), prism = body_of(kPrism);
  const KinematicState still;
  const auto inside = [&](const Vec3& place) { return is_inside({ball, moving(place)}, {prism, still}); };
  EXPECT_TRUE(inside({-0.5, -0.5, 0}));
  EXPECT_FALSE(inside({0.5, 0.5, 0})) << "in the notch";
  EXPECT_FALSE(inside({-0.9, 0, 0})) << "across a face";
  EXPECT_FALSE(is_inside({prism, still}, {ball, moving({-0.5, -0.5, 0})}));
  KinematicState turned = moving({10, 0, 0});
  turned.orientation = Quat(Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitZ()));  // the notch is at -x, +y
  EXPECT_TRUE(is_inside({ball, moving({10.5, 0.5, 0})}, {prism, turned}));
  EXPECT_FALSE(is_inside({ball, moving({9.5, 0.5, 0})}, {prism, turned}));
}

}  // namespace peerd::collision::containment_test
