#include "core/x3d/x3d_words.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace peerd::vrml {
namespace {

using enum FieldType;

constexpr FieldSpec x3d_node(std::string_view name, std::uint16_t accepts) {
  return {name, kSFNode, Access::kExposedField, "NULL", Range::kAny, accepts};
}
constexpr FieldSpec x3d_flag(std::string_view name) { return {name, kSFBool, Access::kField, "TRUE"}; }

// The fields that X3DComposedGeometryNode has in common, and one that says how its corners make polygons.
template <std::size_t kCount>
constexpr std::array<FieldSpec, 8 + kCount> polygon_fields(const std::array<FieldSpec, kCount>& own) {
  std::array<FieldSpec, 8 + kCount> fields{x3d_node("color", kColor),
                                           x3d_node("coord", kCoordinate),
                                           x3d_node("normal", kNormal),
                                           x3d_node("texCoord", kTextureCoordinate),
                                           x3d_flag("ccw"),
                                           x3d_flag("colorPerVertex"),
                                           x3d_flag("normalPerVertex"),
                                           x3d_flag("solid")};
  std::ranges::copy(own, fields.begin() + 8);
  return fields;
}
constexpr auto kPlainSet = polygon_fields<0>({});
constexpr auto kIndexedSet = polygon_fields<2>(
    {FieldSpec{"index", kMFInt32, Access::kField, "[ ]"}, FieldSpec{"set_index", kMFInt32, Access::kEventIn, {}}});
constexpr auto kFanSet = polygon_fields<1>({FieldSpec{"fanCount", kMFInt32, Access::kExposedField, "[ ]"}});
constexpr auto kStripSet = polygon_fields<1>({FieldSpec{"stripCount", kMFInt32, Access::kExposedField, "[ ]"}});
constexpr FieldSpec kColorRgba[] = {{"color", kMFColorRGBA, Access::kExposedField, "[ ]"}};

constexpr NodeType kX3dTypes[] = {
    {"ColorRGBA", kColor, NodeRole::kDisplay, kColorRgba},
    {"IndexedQuadSet", kGeometry, NodeRole::kGeometry, kIndexedSet},
    {"IndexedTriangleFanSet", kGeometry, NodeRole::kGeometry, kIndexedSet},
    {"IndexedTriangleSet", kGeometry, NodeRole::kGeometry, kIndexedSet},
    {"IndexedTriangleStripSet", kGeometry, NodeRole::kGeometry, kIndexedSet},
    {"QuadSet", kGeometry, NodeRole::kGeometry, kPlainSet},
    {"TriangleFanSet", kGeometry, NodeRole::kGeometry, kFanSet},
    {"TriangleSet", kGeometry, NodeRole::kGeometry, kPlainSet},
    {"TriangleStripSet", kGeometry, NodeRole::kGeometry, kStripSet},
};

// Nodes that are read as nodes of VRML97 with the same fields.
constexpr std::pair<std::string_view, std::string_view> kReadAs[] = {{"CADAssembly", "Group"},
                                                                     {"CADFace", "Group"},
                                                                     {"CADLayer", "Group"},
                                                                     {"CADPart", "Transform"},
                                                                     {"StaticGroup", "Group"}};

// The other nodes of X3D 4.0, which no document keeps. X3D's KeySensor is not the one of VRML97 worlds here.
constexpr std::string_view kOtherNodes[] = {
    "AcousticProperties",
    "Analyser",
    "Arc2D",
    "ArcClose2D",
    "AudioDestination",
    "BallJoint",
    "BiquadFilter",
    "BlendedVolumeStyle",
    "BooleanFilter",
    "BooleanSequencer",
    "BooleanToggle",
    "BooleanTrigger",
    "BoundaryEnhancementVolumeStyle",
    "BoundedPhysicsModel",
    "BufferAudioSource",
    "CartoonVolumeStyle",
    "ChannelMerger",
    "ChannelSelector",
    "ChannelSplitter",
    "Circle2D",
    "ClipPlane",
    "CollidableOffset",
    "CollidableShape",
    "CollisionCollection",
    "CollisionSensor",
    "CollisionSpace",
    "ColorChaser",
    "ColorDamper",
    "ComposedCubeMapTexture",
    "ComposedShader",
    "ComposedTexture3D",
    "ComposedVolumeStyle",
    "ConeEmitter",
    "Contact",
    "Contour2D",
    "ContourPolyline2D",
    "Convolver",
    "CoordinateChaser",
    "CoordinateDamper",
    "CoordinateDouble",
    "CoordinateInterpolator2D",
    "DISEntityManager",
    "DISEntityTypeMapping",
    "Delay",
    "Disk2D",
    "DoubleAxisHingeJoint",
    "DynamicsCompressor",
    "EaseInEaseOut",
    "EdgeEnhancementVolumeStyle",
    "EnvironmentLight",
    "EspduTransform",
    "ExplosionEmitter",
    "FillProperties",
    "FloatVertexAttribute",
    "FogCoordinate",
    "ForcePhysicsModel",
    "Gain",
    "GeneratedCubeMapTexture",
    "GeoCoordinate",
    "GeoElevationGrid",
    "GeoLOD",
    "GeoLocation",
    "GeoMetadata",
    "GeoOrigin",
    "GeoPositionInterpolator",
    "GeoProximitySensor",
    "GeoTouchSensor",
    "GeoTransform",
    "GeoViewpoint",
    "HAnimDisplacer",
    "HAnimHumanoid",
    "HAnimJoint",
    "HAnimMotion",
    "HAnimSegment",
    "HAnimSite",
    "ImageCubeMapTexture",
    "ImageTexture3D",
    "IntegerSequencer",
    "IntegerTrigger",
    "IsoSurfaceVolumeData",
    "KeySensor",
    "Layer",
    "LayerSet",
    "Layout",
    "LayoutGroup",
    "LayoutLayer",
    "LinePickSensor",
    "LineProperties",
    "LineSet",
    "ListenerPointSource",
    "LoadSensor",
    "LocalFog",
    "Matrix3VertexAttribute",
    "Matrix4VertexAttribute",
    "MetadataBoolean",
    "MetadataDouble",
    "MetadataFloat",
    "MetadataInteger",
    "MetadataSet",
    "MetadataString",
    "MicrophoneSource",
    "MotorJoint",
    "MultiTexture",
    "MultiTextureCoordinate",
    "MultiTextureTransform",
    "NurbsCurve",
    "NurbsCurve2D",
    "NurbsOrientationInterpolator",
    "NurbsPatchSurface",
    "NurbsPositionInterpolator",
    "NurbsSet",
    "NurbsSurfaceInterpolator",
    "NurbsSweptSurface",
    "NurbsSwungSurface",
    "NurbsTextureCoordinate",
    "NurbsTrimmedSurface",
    "OpacityMapVolumeStyle",
    "OrientationChaser",
    "OrientationDamper",
    "OrthoViewpoint",
    "OscillatorSource",
    "PackagedShader",
    "ParticleSystem",
    "PeriodicWave",
    "PhysicalMaterial",
    "PickableGroup",
    "PixelTexture3D",
    "PointEmitter",
    "PointPickSensor",
    "PointProperties",
    "Polyline2D",
    "PolylineEmitter",
    "Polypoint2D",
    "PositionChaser",
    "PositionChaser2D",
    "PositionDamper",
    "PositionDamper2D",
    "PositionInterpolator2D",
    "PrimitivePickSensor",
    "ProgramShader",
    "ProjectionVolumeStyle",
    "ReceiverPdu",
    "Rectangle2D",
    "RigidBody",
    "RigidBodyCollection",
    "ScalarChaser",
    "ScalarDamper",
    "ScreenFontStyle",
    "ScreenGroup",
    "SegmentedVolumeData",
    "ShadedVolumeStyle",
    "ShaderPart",
    "ShaderProgram",
    "SignalPdu",
    "SilhouetteEnhancementVolumeStyle",
    "SingleAxisHingeJoint",
    "SliderJoint",
    "SpatialSound",
    "SplinePositionInterpolator",
    "SplinePositionInterpolator2D",
    "SplineScalarInterpolator",
    "SquadOrientationInterpolator",
    "StreamAudioDestination",
    "StreamAudioSource",
    "StringSensor",
    "SurfaceEmitter",
    "TexCoordChaser2D",
    "TexCoordDamper2D",
    "TextureBackground",
    "TextureCoordinate3D",
    "TextureCoordinate4D",
    "TextureCoordinateGenerator",
    "TextureProjector",
    "TextureProjectorParallel",
    "TextureProperties",
    "TextureTransform3D",
    "TextureTransformMatrix3D",
    "TimeTrigger",
    "ToneMappedVolumeStyle",
    "TransformSensor",
    "TransmitterPdu",
    "TriangleSet2D",
    "TwoSidedMaterial",
    "UniversalJoint",
    "UnlitMaterial",
    "ViewpointGroup",
    "Viewport",
    "VolumeData",
    "VolumeEmitter",
    "VolumePickSensor",
    "WaveShaper",
    "WindPhysicsModel",
};
static_assert(std::ranges::is_sorted(kOtherNodes));
// The fields that these belong to where XML does not say it; the others are children.
constexpr std::pair<std::string_view, std::string_view> kOtherContainers[] = {
    {"AcousticProperties", "acousticProperties"},
    {"Arc2D", "geometry"},
    {"ArcClose2D", "geometry"},
    {"BallJoint", "joints"},
    {"BlendedVolumeStyle", "renderStyle"},
    {"BoundaryEnhancementVolumeStyle", "renderStyle"},
    {"BoundedPhysicsModel", "physics"},
    {"CartoonVolumeStyle", "renderStyle"},
    {"Circle2D", "geometry"},
    {"CollisionCollection", "collider"},
    {"ComposedCubeMapTexture", "texture"},
    {"ComposedShader", "shaders"},
    {"ComposedTexture3D", "texture"},
    {"ComposedVolumeStyle", "renderStyle"},
    {"ConeEmitter", "emitter"},
    {"Contact", "contacts"},
    {"Contour2D", "trimmingContour"},
    {"CoordinateDouble", "coord"},
    {"Disk2D", "geometry"},
    {"DoubleAxisHingeJoint", "joints"},
    {"EdgeEnhancementVolumeStyle", "renderStyle"},
    {"ExplosionEmitter", "emitter"},
    {"FillProperties", "fillProperties"},
    {"FloatVertexAttribute", "attrib"},
    {"FogCoordinate", "fogCoord"},
    {"ForcePhysicsModel", "physics"},
    {"GeneratedCubeMapTexture", "texture"},
    {"GeoCoordinate", "coord"},
    {"GeoElevationGrid", "geometry"},
    {"GeoOrigin", "geoOrigin"},
    {"HAnimDisplacer", "displacers"},
    {"HAnimMotion", "motions"},
    {"ImageCubeMapTexture", "texture"},
    {"ImageTexture3D", "texture"},
    {"Layer", "layers"},
    {"Layout", "layout"},
    {"LayoutLayer", "layers"},
    {"LineProperties", "lineProperties"},
    {"LineSet", "geometry"},
    {"Matrix3VertexAttribute", "attrib"},
    {"Matrix4VertexAttribute", "attrib"},
    {"MetadataBoolean", "value"},
    {"MetadataDouble", "value"},
    {"MetadataFloat", "value"},
    {"MetadataInteger", "value"},
    {"MetadataSet", "value"},
    {"MetadataString", "value"},
    {"MotorJoint", "joints"},
    {"MultiTexture", "texture"},
    {"MultiTextureCoordinate", "texCoord"},
    {"MultiTextureTransform", "textureTransform"},
    {"NurbsCurve", "geometry"},
    {"NurbsPatchSurface", "geometry"},
    {"NurbsSweptSurface", "geometry"},
    {"NurbsSwungSurface", "geometry"},
    {"NurbsTextureCoordinate", "texCoord"},
    {"NurbsTrimmedSurface", "geometry"},
    {"OpacityMapVolumeStyle", "renderStyle"},
    {"PackagedShader", "shaders"},
    {"PeriodicWave", "periodicWave"},
    {"PhysicalMaterial", "material"},
    {"PixelTexture3D", "texture"},
    {"PointEmitter", "emitter"},
    {"PointProperties", "pointProperties"},
    {"Polyline2D", "geometry"},
    {"PolylineEmitter", "emitter"},
    {"Polypoint2D", "geometry"},
    {"ProgramShader", "shaders"},
    {"ProjectionVolumeStyle", "renderStyle"},
    {"Rectangle2D", "geometry"},
    {"RigidBody", "bodies"},
    {"ScreenFontStyle", "fontStyle"},
    {"ShadedVolumeStyle", "renderStyle"},
    {"ShaderPart", "parts"},
    {"ShaderProgram", "programs"},
    {"SilhouetteEnhancementVolumeStyle", "renderStyle"},
    {"SingleAxisHingeJoint", "joints"},
    {"SliderJoint", "joints"},
    {"SurfaceEmitter", "emitter"},
    {"TextureCoordinate3D", "texCoord"},
    {"TextureCoordinate4D", "texCoord"},
    {"TextureCoordinateGenerator", "texCoord"},
    {"TextureProperties", "textureProperties"},
    {"TextureTransform3D", "textureTransform"},
    {"TextureTransformMatrix3D", "textureTransform"},
    {"ToneMappedVolumeStyle", "renderStyle"},
    {"TriangleSet2D", "geometry"},
    {"TwoSidedMaterial", "material"},
    {"UniversalJoint", "joints"},
    {"UnlitMaterial", "material"},
    {"Viewport", "viewport"},
    {"VolumeEmitter", "emitter"},
    {"WindPhysicsModel", "physics"},
};
static_assert(std::ranges::is_sorted(kOtherContainers));

struct Renamed {
  std::string_view node, x3d, vrml;
};
constexpr Renamed kRenamed[] = {{"Collision", "enabled", "collide"},
                                {"Group", "shape", "children"},
                                {"LOD", "children", "level"},
                                {"Switch", "children", "choice"}};

constexpr std::pair<std::uint16_t, std::string_view> kContainers[] = {
    {kAppearance, "appearance"},
    {kMaterial, "material"},
    {kTexture, "texture"},
    {kTextureTransform, "textureTransform"},
    {kGeometry, "geometry"},
    {kCoordinate, "coord"},
    {kColor, "color"},
    {kNormal, "normal"},
    {kTextureCoordinate, "texCoord"},
    {kFontStyle, "fontStyle"},
    {kCollisionResponse, "collisionResponse"},
    {kSoundSource, "source"},
};

constexpr std::pair<std::string_view, Access> kAccesses[] = {{"initializeOnly", Access::kField},
                                                             {"inputOutput", Access::kExposedField},
                                                             {"inputOnly", Access::kEventIn},
                                                             {"outputOnly", Access::kEventOut}};

}  // namespace

const NodeType* find_x3d_type(std::string_view name) {
  const auto own = std::ranges::find(kX3dTypes, name, &NodeType::name);
  if (own != std::end(kX3dTypes)) return &*own;
  const auto same = std::ranges::find(kReadAs, name, &std::pair<std::string_view, std::string_view>::first);
  if (same != std::end(kReadAs)) return find_node_type(same->second);
  return is_unkept_x3d_node(name) ? nullptr : find_node_type(name);
}

bool is_unkept_x3d_node(std::string_view name) { return std::ranges::binary_search(kOtherNodes, name); }

std::string_view vrml_field_name(std::string_view node, std::string_view x3d_name) {
  for (const Renamed& renamed : kRenamed) {
    if (renamed.node == node && renamed.x3d == x3d_name) return renamed.vrml;
  }
  return x3d_name;
}

std::string_view container_of(std::string_view name) {
  const auto other = std::ranges::find(kOtherContainers, name, &std::pair<std::string_view, std::string_view>::first);
  if (other != std::end(kOtherContainers)) return other->second;
  const NodeType* const type = find_x3d_type(name);
  const std::uint16_t classes = type == nullptr ? std::uint16_t{kChild} : type->classes;
  for (const auto& [node_class, container] : kContainers) {
    if ((classes & node_class) != 0 && (classes & kChild) == 0) return container;
  }
  return "children";
}

std::optional<Access> find_x3d_access(std::string_view word) {
  for (const auto& [name, access] : kAccesses) {
    if (name == word) return access;
  }
  return find_access(word);
}

std::string_view x3d_name_of(Access access) {
  for (const auto& [name, known] : kAccesses) {
    if (known == access) return name;
  }
  return name_of(access);
}

}  // namespace peerd::vrml
