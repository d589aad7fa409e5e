#include "core/vrml/node_types.hpp"

#include <algorithm>

namespace peerd::vrml {
namespace {

using enum FieldType;

constexpr FieldSpec field(std::string_view name, FieldType type, std::string_view value, Range range = Range::kAny) {
  return {name, type, Access::kField, value, range, 0};
}
constexpr FieldSpec exposed(std::string_view name, FieldType type, std::string_view value, Range range = Range::kAny) {
  return {name, type, Access::kExposedField, value, range, 0};
}
constexpr FieldSpec node(std::string_view name, std::uint16_t accepts) {
  return {name, kSFNode, Access::kExposedField, "NULL", Range::kAny, accepts};
}
constexpr FieldSpec event_in(std::string_view name, FieldType type) { return {name, type, Access::kEventIn, {}}; }
constexpr FieldSpec event_out(std::string_view name, FieldType type) { return {name, type, Access::kEventOut, {}}; }

constexpr FieldSpec kChildren = {"children", kMFNode, Access::kExposedField, "[ ]", Range::kAny, kChild};
constexpr FieldSpec kBoxCenter = field("bboxCenter", kSFVec3f, "0 0 0");
constexpr FieldSpec kBoxSize = field("bboxSize", kSFVec3f, "-1 -1 -1");
constexpr Range kPositive = Range::kPositive;
constexpr Range kNonNegative = Range::kNonNegative;

// The tables: VRML97 clause 6, in its order of fields, with the seed's appendix C.

constexpr FieldSpec kAppearanceFields[] = {
    node("material", kMaterial),
    node("texture", kTexture),
    node("textureTransform", kTextureTransform),
};
constexpr FieldSpec kBackgroundFields[] = {
    event_in("set_bind", kSFBool),           exposed("groundAngle", kMFFloat, "[ ]"),
    exposed("groundColor", kMFColor, "[ ]"), exposed("backUrl", kMFString, "[ ]"),
    exposed("bottomUrl", kMFString, "[ ]"),  exposed("frontUrl", kMFString, "[ ]"),
    exposed("leftUrl", kMFString, "[ ]"),    exposed("rightUrl", kMFString, "[ ]"),
    exposed("topUrl", kMFString, "[ ]"),     exposed("skyAngle", kMFFloat, "[ ]"),
    exposed("skyColor", kMFColor, "0 0 0"),  event_out("isBound", kSFBool),
};
constexpr FieldSpec kBoxFields[] = {
    field("size", kSFVec3f, "2 2 2", kPositive),
};
constexpr FieldSpec kCollisionInterestFields[] = {
    // Listing 3.3 of the seed writes collisionInterests where its appendix C.1 has interests.
    field("objectPath", kSFString, "\"\""),
    field("interests", kMFString, "[ ]"),
    field("collisionInterests", kMFString, "[ ]"),
    field("collisionType", kSFInt32, "0", kNonNegative),
};
constexpr FieldSpec kCollisionResponseFields[] = {
    field("responseType", kSFInt32, "0", kNonNegative),
    field("setBack", kSFBool, "TRUE"),
};
constexpr FieldSpec kColorFields[] = {
    exposed("color", kMFColor, "[ ]"),
};
constexpr FieldSpec kConeFields[] = {
    field("bottomRadius", kSFFloat, "1", kPositive),
    field("height", kSFFloat, "2", kPositive),
    field("side", kSFBool, "TRUE"),
    field("bottom", kSFBool, "TRUE"),
};
constexpr FieldSpec kCoordinateFields[] = {
    exposed("point", kMFVec3f, "[ ]"),
};
constexpr FieldSpec kCylinderFields[] = {
    field("bottom", kSFBool, "TRUE"),
    field("height", kSFFloat, "2", kPositive),
    field("radius", kSFFloat, "1", kPositive),
    field("side", kSFBool, "TRUE"),
    field("top", kSFBool, "TRUE"),
};
constexpr FieldSpec kDirectionalLightFields[] = {
    exposed("ambientIntensity", kSFFloat, "0"),
    exposed("color", kSFColor, "1 1 1"),
    exposed("direction", kSFVec3f, "0 0 -1"),
    exposed("intensity", kSFFloat, "1"),
    exposed("on", kSFBool, "TRUE"),
};
constexpr FieldSpec kElevationGridFields[] = {
    event_in("set_height", kMFFloat),
    node("color", kColor),
    node("normal", kNormal),
    node("texCoord", kTextureCoordinate),
    field("height", kMFFloat, "[ ]"),
    field("ccw", kSFBool, "TRUE"),
    field("colorPerVertex", kSFBool, "TRUE"),
    field("creaseAngle", kSFFloat, "0", kNonNegative),
    field("normalPerVertex", kSFBool, "TRUE"),
    field("solid", kSFBool, "TRUE"),
    field("xDimension", kSFInt32, "0", kNonNegative),
    field("xSpacing", kSFFloat, "1.0", kPositive),
    field("zDimension", kSFInt32, "0", kNonNegative),
    field("zSpacing", kSFFloat, "1.0", kPositive),
};
constexpr FieldSpec kExtrusionFields[] = {
    event_in("set_crossSection", kMFVec2f),
    event_in("set_orientation", kMFRotation),
    event_in("set_scale", kMFVec2f),
    event_in("set_spine", kMFVec3f),
    field("beginCap", kSFBool, "TRUE"),
    field("ccw", kSFBool, "TRUE"),
    field("convex", kSFBool, "TRUE"),
    field("creaseAngle", kSFFloat, "0", kNonNegative),
    field("crossSection", kMFVec2f, "[ 1 1, 1 -1, -1 -1, -1 1, 1 1 ]"),
    field("endCap", kSFBool, "TRUE"),
    field("orientation", kMFRotation, "0 0 1 0"),
    field("scale", kMFVec2f, "1 1", kNonNegative),
    field("solid", kSFBool, "TRUE"),
    field("spine", kMFVec3f, "[ 0 0 0, 0 1 0 ]"),
};
constexpr FieldSpec kFogFields[] = {
    exposed("color", kSFColor, "1 1 1"),
    exposed("fogType", kSFString, "\"LINEAR\""),
    exposed("visibilityRange", kSFFloat, "0", kNonNegative),
    event_in("set_bind", kSFBool),
    event_out("isBound", kSFBool),
};
constexpr FieldSpec kFontStyleFields[] = {
    field("family", kMFString, "\"SERIF\""),         field("horizontal", kSFBool, "TRUE"),
    field("justify", kMFString, "\"BEGIN\""),        field("language", kSFString, "\"\""),
    field("leftToRight", kSFBool, "TRUE"),           field("size", kSFFloat, "1.0", kPositive),
    field("spacing", kSFFloat, "1.0", kNonNegative), field("style", kSFString, "\"PLAIN\""),
    field("topToBottom", kSFBool, "TRUE"),
};
constexpr FieldSpec kGroupFields[] = {
    event_in("addChildren", kMFNode), event_in("removeChildren", kMFNode), kChildren, kBoxCenter, kBoxSize,
};
constexpr FieldSpec kImageTextureFields[] = {
    exposed("url", kMFString, "[ ]"),
    field("repeatS", kSFBool, "TRUE"),
    field("repeatT", kSFBool, "TRUE"),
};
constexpr FieldSpec kIndexedFaceSetFields[] = {
    event_in("set_colorIndex", kMFInt32),
    event_in("set_coordIndex", kMFInt32),
    event_in("set_normalIndex", kMFInt32),
    event_in("set_texCoordIndex", kMFInt32),
    node("color", kColor),
    node("coord", kCoordinate),
    node("normal", kNormal),
    node("texCoord", kTextureCoordinate),
    field("ccw", kSFBool, "TRUE"),
    field("colorIndex", kMFInt32, "[ ]"),
    field("colorPerVertex", kSFBool, "TRUE"),
    field("convex", kSFBool, "TRUE"),
    field("coordIndex", kMFInt32, "[ ]"),
    field("creaseAngle", kSFFloat, "0", kNonNegative),
    field("normalIndex", kMFInt32, "[ ]"),
    field("normalPerVertex", kSFBool, "TRUE"),
    field("solid", kSFBool, "TRUE"),
    field("texCoordIndex", kMFInt32, "[ ]"),
};
constexpr FieldSpec kIndexedLineSetFields[] = {
    event_in("set_colorIndex", kMFInt32),
    event_in("set_coordIndex", kMFInt32),
    node("color", kColor),
    node("coord", kCoordinate),
    field("colorIndex", kMFInt32, "[ ]"),
    field("colorPerVertex", kSFBool, "TRUE"),
    field("coordIndex", kMFInt32, "[ ]"),
};
constexpr FieldSpec kMaterialFields[] = {
    exposed("ambientIntensity", kSFFloat, "0.2"), exposed("diffuseColor", kSFColor, "0.8 0.8 0.8"),
    exposed("emissiveColor", kSFColor, "0 0 0"),  exposed("shininess", kSFFloat, "0.2"),
    exposed("specularColor", kSFColor, "0 0 0"),  exposed("transparency", kSFFloat, "0"),
};
constexpr FieldSpec kNavigationInfoFields[] = {
    event_in("set_bind", kSFBool),
    exposed("avatarSize", kMFFloat, "[ 0.25, 1.6, 0.75 ]", kNonNegative),
    exposed("headlight", kSFBool, "TRUE"),
    exposed("speed", kSFFloat, "1.0", kNonNegative),
    exposed("type", kMFString, "[ \"WALK\", \"ANY\" ]"),
    exposed("visibilityLimit", kSFFloat, "0.0", kNonNegative),
    event_out("isBound", kSFBool),
};
constexpr FieldSpec kNormalFields[] = {
    exposed("vector", kMFVec3f, "[ ]"),
};
constexpr FieldSpec kPixelTextureFields[] = {
    exposed("image", kSFImage, "0 0 0"),
    field("repeatS", kSFBool, "TRUE"),
    field("repeatT", kSFBool, "TRUE"),
};
constexpr FieldSpec kPointLightFields[] = {
    exposed("ambientIntensity", kSFFloat, "0"),
    exposed("attenuation", kSFVec3f, "1 0 0", kNonNegative),
    exposed("color", kSFColor, "1 1 1"),
    exposed("intensity", kSFFloat, "1"),
    exposed("location", kSFVec3f, "0 0 0"),
    exposed("on", kSFBool, "TRUE"),
    exposed("radius", kSFFloat, "100", kNonNegative),
};
constexpr FieldSpec kPointSetFields[] = {
    node("color", kColor),
    node("coord", kCoordinate),
};
constexpr FieldSpec kShapeFields[] = {
    node("appearance", kAppearance),
    node("geometry", kGeometry),
    field("convexHull", kMFVec3f, "[ ]"),
    field("hierarchyFile", kSFString, "\"\""),
    field("splitThreshold", kSFInt32, "10", kPositive),
};
constexpr FieldSpec kSphereFields[] = {
    field("radius", kSFFloat, "1", kPositive),
};
constexpr FieldSpec kSpotLightFields[] = {
    exposed("ambientIntensity", kSFFloat, "0"),
    exposed("attenuation", kSFVec3f, "1 0 0", kNonNegative),
    exposed("beamWidth", kSFFloat, "1.570796", kPositive),
    exposed("color", kSFColor, "1 1 1"),
    exposed("cutOffAngle", kSFFloat, "0.785398", kPositive),
    exposed("direction", kSFVec3f, "0 0 -1"),
    exposed("intensity", kSFFloat, "1"),
    exposed("location", kSFVec3f, "0 0 0"),
    exposed("on", kSFBool, "TRUE"),
    exposed("radius", kSFFloat, "100", kNonNegative),
};
constexpr FieldSpec kTextFields[] = {
    exposed("string", kMFString, "[ ]"),
    node("fontStyle", kFontStyle),
    exposed("length", kMFFloat, "[ ]", kNonNegative),
    exposed("maxExtent", kSFFloat, "0.0", kNonNegative),
};
constexpr FieldSpec kTextureCoordinateFields[] = {
    exposed("point", kMFVec2f, "[ ]"),
};
constexpr FieldSpec kTextureTransformFields[] = {
    exposed("center", kSFVec2f, "0 0"),
    exposed("rotation", kSFFloat, "0"),
    exposed("scale", kSFVec2f, "1 1"),
    exposed("translation", kSFVec2f, "0 0"),
};
constexpr FieldSpec kTransformFields[] = {
    event_in("addChildren", kMFNode),
    event_in("removeChildren", kMFNode),
    exposed("center", kSFVec3f, "0 0 0"),
    kChildren,
    node("collisionResponse", kCollisionResponse),
    exposed("distanceThreshold", kSFFloat, "0.5", kNonNegative),
    exposed("enslaved", kSFBool, "FALSE"),  // C.5 prints SFFloat, and FALSE
    exposed("remote", kSFBool, "FALSE"),
    exposed("rotation", kSFRotation, "0 0 1 0"),
    exposed("scale", kSFVec3f,
            "1 1 1"),  // the standard says > 0; the scene builder warns, for mirrored parts are common
    exposed("scaleOrientation", kSFRotation, "0 0 1 0"),
    exposed("translation", kSFVec3f, "0 0 0"),
    exposed("velocityVector", kSFVec3f, "0 0 0"),
    kBoxCenter,
    kBoxSize,
    event_out("notColliding", kSFBool),
};
constexpr FieldSpec kViewpointFields[] = {
    event_in("set_bind", kSFBool),           exposed("fieldOfView", kSFFloat, "0.785398", kPositive),
    exposed("jump", kSFBool, "TRUE"),        exposed("orientation", kSFRotation, "0 0 1 0"),
    exposed("position", kSFVec3f, "0 0 10"), field("description", kSFString, "\"\""),
    event_out("bindTime", kSFTime),          event_out("isBound", kSFBool),
};
constexpr FieldSpec kWorldInfoFields[] = {
    field("info", kMFString, "[ ]"),
    field("title", kSFString, "\"\""),
};

constexpr NodeType kNodeTypes[] = {
    {"Appearance", kAppearance, Meaning::kPart, kAppearanceFields},
    {"Background", kChild, Meaning::kPart, kBackgroundFields},
    {"Box", kGeometry, Meaning::kBox, kBoxFields},
    {"CollisionInterest", kChild, Meaning::kCollisionInterest, kCollisionInterestFields},
    {"CollisionResponse", kCollisionResponse, Meaning::kPart, kCollisionResponseFields},
    {"Color", kColor, Meaning::kPart, kColorFields},
    {"Cone", kGeometry, Meaning::kOtherGeometry, kConeFields},
    {"Coordinate", kCoordinate, Meaning::kPart, kCoordinateFields},
    {"Cylinder", kGeometry, Meaning::kOtherGeometry, kCylinderFields},
    {"DirectionalLight", kChild, Meaning::kPart, kDirectionalLightFields},
    {"ElevationGrid", kGeometry, Meaning::kOtherGeometry, kElevationGridFields},
    {"Extrusion", kGeometry, Meaning::kOtherGeometry, kExtrusionFields},
    {"Fog", kChild, Meaning::kPart, kFogFields},
    {"FontStyle", kFontStyle, Meaning::kPart, kFontStyleFields},
    {"Group", kChild, Meaning::kGroup, kGroupFields},
    {"ImageTexture", kTexture, Meaning::kPart, kImageTextureFields},
    {"IndexedFaceSet", kGeometry, Meaning::kIndexedFaceSet, kIndexedFaceSetFields},
    {"IndexedLineSet", kGeometry, Meaning::kOtherGeometry, kIndexedLineSetFields},
    {"Material", kMaterial, Meaning::kPart, kMaterialFields},
    {"NavigationInfo", kChild, Meaning::kPart, kNavigationInfoFields},
    {"Normal", kNormal, Meaning::kPart, kNormalFields},
    {"PixelTexture", kTexture, Meaning::kPart, kPixelTextureFields},
    {"PointLight", kChild, Meaning::kPart, kPointLightFields},
    {"PointSet", kGeometry, Meaning::kOtherGeometry, kPointSetFields},
    {"Shape", kChild, Meaning::kShape, kShapeFields},
    {"Sphere", kGeometry, Meaning::kOtherGeometry, kSphereFields},
    {"SpotLight", kChild, Meaning::kPart, kSpotLightFields},
    {"Text", kGeometry, Meaning::kOtherGeometry, kTextFields},
    {"TextureCoordinate", kTextureCoordinate, Meaning::kPart, kTextureCoordinateFields},
    {"TextureTransform", kTextureTransform, Meaning::kPart, kTextureTransformFields},
    {"Transform", kChild, Meaning::kTransform, kTransformFields},
    {"Viewpoint", kChild, Meaning::kPart, kViewpointFields},
    {"WorldInfo", kChild, Meaning::kPart, kWorldInfoFields},
};

constexpr std::string_view kNotReadYet[] = {
    "Anchor",
    "AudioClip",
    "Billboard",
    "Collision",
    "ColorInterpolator",
    "CoordinateInterpolator",
    "CylinderSensor",
    "Inline",
    "KeySensor",
    "LOD",
    "MovieTexture",
    "NormalInterpolator",
    "OrientationInterpolator",
    "PlaneSensor",
    "PositionInterpolator",
    "ProximitySensor",
    "ScalarInterpolator",
    "Script",
    "Sound",
    "SphereSensor",
    "Switch",
    "TimeSensor",
    "TouchSensor",
    "VisibilitySensor",
};

}  // namespace

std::span<const NodeType> node_types() { return kNodeTypes; }

const NodeType* find_node_type(std::string_view name) {
  const auto it = std::ranges::find(kNodeTypes, name, &NodeType::name);
  return it == std::end(kNodeTypes) ? nullptr : it;
}

const FieldSpec* find_field(const NodeType& type, std::string_view name) {
  const auto it = std::ranges::find(type.fields, name, &FieldSpec::name);
  return it == type.fields.end() ? nullptr : &*it;
}

std::span<const std::string_view> nodes_not_read_yet() { return kNotReadYet; }

std::string_view name_of(FieldType type) {
  constexpr std::string_view kNames[] = {"SFBool",     "SFColor",    "SFFloat",  "SFImage", "SFInt32",
                                         "SFNode",     "SFRotation", "SFString", "SFTime",  "SFVec2f",
                                         "SFVec3f",    "MFColor",    "MFFloat",  "MFInt32", "MFNode",
                                         "MFRotation", "MFString",   "MFTime",   "MFVec2f", "MFVec3f"};
  return kNames[static_cast<std::size_t>(type)];
}

std::string_view name_of(NodeClass node_class) {
  switch (node_class) {
    case kChild:
      return "a child of a group";
    case kAppearance:
      return "an Appearance";
    case kMaterial:
      return "a Material";
    case kTexture:
      return "a texture";
    case kTextureTransform:
      return "a TextureTransform";
    case kGeometry:
      return "a geometry node";
    case kCoordinate:
      return "a Coordinate";
    case kColor:
      return "a Color";
    case kNormal:
      return "a Normal";
    case kTextureCoordinate:
      return "a TextureCoordinate";
    case kFontStyle:
      return "a FontStyle";
    case kCollisionResponse:
      return "a CollisionResponse";
  }
  return "another node";
}

int float_count(FieldType type) {
  switch (type) {
    case kSFFloat:
    case kMFFloat:
      return 1;
    case kSFVec2f:
    case kMFVec2f:
      return 2;
    case kSFColor:
    case kMFColor:
    case kSFVec3f:
    case kMFVec3f:
      return 3;
    case kSFRotation:
    case kMFRotation:
      return 4;
    default:
      return 0;
  }
}

bool is_list(FieldType type) { return type >= kMFColor; }

}  // namespace peerd::vrml
