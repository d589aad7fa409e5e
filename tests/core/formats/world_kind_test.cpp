#include "core/formats/world_kind.hpp"

#include <gtest/gtest.h>

#include <string>

namespace peerd::formats::world_kind_test {
namespace {

struct Case {
  const char* name;
  std::string bytes, file;
  WorldKind kind;
};

class KindOf : public testing::TestWithParam<Case> {};

TEST_P(KindOf, IsTheContentsBeforeTheNames) { EXPECT_EQ(kind_of(GetParam().bytes, GetParam().file), GetParam().kind); }

std::string binary_stl(std::string header) {
  header.resize(84, '\0');
  header[80] = 1;
  return header + std::string(50, '\0');
}

INSTANTIATE_TEST_SUITE_P(
    Table, KindOf,
    testing::Values(Case{"Vrml", "#VRML V2.0 utf8\n", "world.obj", WorldKind::kVrml},
                    Case{"Nothing", "", "world", WorldKind::kVrml},
                    Case{"NothingOfAName", "", "world.GLB", WorldKind::kGlb},
                    Case{"ObjBehindComments", "# made by hand\n\n  # twice\nv 0 0 0\n", "x", WorldKind::kObj},
                    Case{"ObjOfMaterials", "mtllib a.mtl\n", "x.wrl", WorldKind::kObj},
                    Case{"StlText", "solid a b\nfacet normal", "x", WorldKind::kStlText},
                    Case{"StlBinary", binary_stl("made"), "x", WorldKind::kStlBinary},
                    Case{"StlBinaryThatSaysSolid", binary_stl("solid"), "x.stl", WorldKind::kStlBinary},
                    Case{"Ply", "ply\r\nformat ascii 1.0\r\n", "x", WorldKind::kPly},
                    Case{"Off", "# c\nCOFF\n", "x", WorldKind::kOff},
                    Case{"X3d", "<?xml version='1.0'?>\n<X3D>", "x.wrl", WorldKind::kX3d},
                    Case{"X3dBehindComments", "\xEF\xBB\xBF <!-- a --><X3D>", "x", WorldKind::kX3d},
                    Case{"X3dClassic", "#X3D V3.0 utf8\n", "x.x3d", WorldKind::kX3dClassic},
                    Case{"X3dPacked", "\x1f\x8b..", "x.x3dz", WorldKind::kX3d},
                    Case{"X3dClassicPacked", "\x1f\x8b..", "x.X3DVZ", WorldKind::kX3dClassic},
                    Case{"VrmlPacked", "\x1f\x8b..", "x.glb", WorldKind::kVrml},
                    Case{"Gltf", " \n{\"asset\"", "x", WorldKind::kGltf},
                    Case{"Glb", "glTF\2", "x.obj", WorldKind::kGlb}),
    [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace peerd::formats::world_kind_test
