#include "core/vrml/node_types.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

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
constexpr std::string_view kInlineContentName = "children";
constexpr Range kPositive = Range::kPositive;
constexpr Range kSize = Range::kSize;
constexpr Range kShouldBeNonNegative = Range::kShouldBeNonNegative;
constexpr Range kShouldBePositive = Range::kShouldBePositive;
constexpr Range kNonNegative = Range::kNonNegative;

// The tables follow clause 6 of VRML97, in its order of fields, with appendix C of the thesis.

constexpr FieldSpec kAnchorFields[] = {
    event_in("addChildren", kMFNode),
    event_in("removeChildren", kMFNode),
    kChildren,
    exposed("description", kSFString, "\"\""),
    exposed("parameter", kMFString, "[ ]"),
    exposed("url", kMFString, "[ ]"),
    kBoxCenter,
    kBoxSize,
};
constexpr FieldSpec kAppearanceFields[] = {
    node("material", kMaterial),
    node("texture", kTexture),
    node("textureTransform", kTextureTransform),
};
constexpr FieldSpec kAudioClipFields[] = {
    exposed("description", kSFString, "\"\""),
    exposed("loop", kSFBool, "FALSE"),
    exposed("pitch", kSFFloat, "1.0", kShouldBePositive),
    exposed("startTime", kSFTime, "0"),
    exposed("stopTime", kSFTime, "0"),
    exposed("url", kMFString, "[ ]"),
    event_out("duration_changed", kSFTime),
    event_out("isActive", kSFBool),
};
constexpr FieldSpec kBackgroundFields[] = {
    event_in("set_bind", kSFBool),           exposed("groundAngle", kMFFloat, "[ ]"),
    exposed("groundColor", kMFColor, "[ ]"), exposed("backUrl", kMFString, "[ ]"),
    exposed("bottomUrl", kMFString, "[ ]"),  exposed("frontUrl", kMFString, "[ ]"),
    exposed("leftUrl", kMFString, "[ ]"),    exposed("rightUrl", kMFString, "[ ]"),
    exposed("topUrl", kMFString, "[ ]"),     exposed("skyAngle", kMFFloat, "[ ]"),
    exposed("skyColor", kMFColor, "0 0 0"),  event_out("isBound", kSFBool),
};
constexpr FieldSpec kBillboardFields[] = {
    event_in("addChildren", kMFNode),
    event_in("removeChildren", kMFNode),
    exposed("axisOfRotation", kSFVec3f, "0 1 0"),
    kChildren,
    kBoxCenter,
    kBoxSize,
};
constexpr FieldSpec kBoxFields[] = {
    field("size", kSFVec3f, "2 2 2", kSize),
};
constexpr FieldSpec kCollisionFields[] = {
    event_in("addChildren", kMFNode),
    event_in("removeChildren", kMFNode),
    kChildren,
    exposed("collide", kSFBool, "TRUE"),
    kBoxCenter,
    kBoxSize,
    {"proxy", kSFNode, Access::kField, "NULL", Range::kAny, kChild},
    event_out("collideTime", kSFTime),
};
constexpr FieldSpec kCollisionInterestFields[] = {
    // Listing 3.3 of the thesis writes collisionInterests where appendix C.1 has interests.
    field("objectPath", kSFString, "\"\""),
    field("interests", kMFString, "[ ]"),
    field("collisionInterests", kMFString, "[ ]"),
    field("collisionType", kSFInt32, "0", kNonNegative),
    field("except", kMFString, "[ ]"),
};
constexpr FieldSpec kCollisionResponseFields[] = {
    field("responseType", kSFInt32, "0", kNonNegative),
    field("setBack", kSFBool, "TRUE"),
    field("mass", kSFFloat, "1", kPositive),
    field("restitution", kSFFloat, "1", kNonNegative),
    field("friction", kSFFloat, "0", kNonNegative),
};
constexpr FieldSpec kColorFields[] = {
    exposed("color", kMFColor, "[ ]"),
};
constexpr FieldSpec kColorInterpolatorFields[] = {
    event_in("set_fraction", kSFFloat),
    exposed("key", kMFFloat, "[ ]"),
    exposed("keyValue", kMFColor, "[ ]"),
    event_out("value_changed", kSFColor),
};
constexpr FieldSpec kConeFields[] = {
    field("bottomRadius", kSFFloat, "1", kSize),
    field("height", kSFFloat, "2", kSize),
    field("side", kSFBool, "TRUE"),
    field("bottom", kSFBool, "TRUE"),
};
constexpr FieldSpec kCoordinateFields[] = {
    exposed("point", kMFVec3f, "[ ]"),
};
constexpr FieldSpec kCoordinateInterpolatorFields[] = {
    event_in("set_fraction", kSFFloat),
    exposed("key", kMFFloat, "[ ]"),
    exposed("keyValue", kMFVec3f, "[ ]"),
    event_out("value_changed", kMFVec3f),
};
constexpr FieldSpec kCylinderFields[] = {
    field("bottom", kSFBool, "TRUE"), field("height", kSFFloat, "2", kSize), field("radius", kSFFloat, "1", kSize),
    field("side", kSFBool, "TRUE"),   field("top", kSFBool, "TRUE"),
};
constexpr FieldSpec kCylinderSensorFields[] = {
    exposed("autoOffset", kSFBool, "TRUE"),
    exposed("diskAngle", kSFFloat, "0.262"),
    exposed("enabled", kSFBool, "TRUE"),
    exposed("maxAngle", kSFFloat, "-1"),
    exposed("minAngle", kSFFloat, "0"),
    exposed("offset", kSFFloat, "0"),
    event_out("isActive", kSFBool),
    event_out("rotation_changed", kSFRotation),
    event_out("trackPoint_changed", kSFVec3f),
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
    field("creaseAngle", kSFFloat, "0", kShouldBeNonNegative),
    field("normalPerVertex", kSFBool, "TRUE"),
    field("solid", kSFBool, "TRUE"),
    field("xDimension", kSFInt32, "0", kNonNegative),
    field("xSpacing", kSFFloat, "1.0", kSize),
    field("zDimension", kSFInt32, "0", kNonNegative),
    field("zSpacing", kSFFloat, "1.0", kSize),
};
constexpr FieldSpec kExtrusionFields[] = {
    event_in("set_crossSection", kMFVec2f),
    event_in("set_orientation", kMFRotation),
    event_in("set_scale", kMFVec2f),
    event_in("set_spine", kMFVec3f),
    field("beginCap", kSFBool, "TRUE"),
    field("ccw", kSFBool, "TRUE"),
    field("convex", kSFBool, "TRUE"),
    field("creaseAngle", kSFFloat, "0", kShouldBeNonNegative),
    field("crossSection", kMFVec2f, "[ 1 1, 1 -1, -1 -1, -1 1, 1 1 ]"),
    field("endCap", kSFBool, "TRUE"),
    field("orientation", kMFRotation, "0 0 1 0"),
    field("scale", kMFVec2f, "1 1", kShouldBeNonNegative),
    field("solid", kSFBool, "TRUE"),
    field("spine", kMFVec3f, "[ 0 0 0, 0 1 0 ]"),
};
constexpr FieldSpec kFogFields[] = {
    exposed("color", kSFColor, "1 1 1"),
    exposed("fogType", kSFString, "\"LINEAR\""),
    exposed("visibilityRange", kSFFloat, "0", kShouldBeNonNegative),
    event_in("set_bind", kSFBool),
    event_out("isBound", kSFBool),
};
constexpr FieldSpec kFontStyleFields[] = {
    field("family", kMFString, "\"SERIF\""),
    field("horizontal", kSFBool, "TRUE"),
    field("justify", kMFString, "\"BEGIN\""),
    field("language", kSFString, "\"\""),
    field("leftToRight", kSFBool, "TRUE"),
    field("size", kSFFloat, "1.0", kShouldBePositive),
    field("spacing", kSFFloat, "1.0", kShouldBeNonNegative),
    field("style", kSFString, "\"PLAIN\""),
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
    field("creaseAngle", kSFFloat, "0", kShouldBeNonNegative),
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
constexpr FieldSpec kInlineFields[] = {
    exposed("url", kMFString, "[ ]"),
    kBoxCenter,
    kBoxSize,
    {kInlineContentName, kMFNode, Access::kContent, "[ ]", Range::kAny, kAnyClass},
};
constexpr FieldSpec kKeySensorFields[] = {
    field("absoluteValue", kSFBool, "FALSE"),
    field("consume", kSFBool, "TRUE"),
    exposed("enabled", kSFBool, "TRUE"),
    field("key", kSFString, "\"\""),
    field("keyState", kSFInt32, "0"),
    field("keyValue", kSFInt32, "0"),
    field("onRelease", kSFBool, "FALSE"),
    field("recipient", kSFString, "\"\""),
    field("value", kSFVec3f, "0 0 0"),
    event_in("disable", kSFBool),
    event_out("keyHit", kSFBool),
};
constexpr FieldSpec kLodFields[] = {
    {"level", kMFNode, Access::kExposedField, "[ ]", Range::kAny, kChild},
    field("center", kSFVec3f, "0 0 0"),
    field("range", kMFFloat, "[ ]", kShouldBePositive),
};
constexpr FieldSpec kMaterialFields[] = {
    exposed("ambientIntensity", kSFFloat, "0.2"), exposed("diffuseColor", kSFColor, "0.8 0.8 0.8"),
    exposed("emissiveColor", kSFColor, "0 0 0"),  exposed("shininess", kSFFloat, "0.2"),
    exposed("specularColor", kSFColor, "0 0 0"),  exposed("transparency", kSFFloat, "0"),
};
constexpr FieldSpec kMovieTextureFields[] = {
    exposed("loop", kSFBool, "FALSE"), exposed("speed", kSFFloat, "1.0"),      exposed("startTime", kSFTime, "0"),
    exposed("stopTime", kSFTime, "0"), exposed("url", kMFString, "[ ]"),       field("repeatS", kSFBool, "TRUE"),
    field("repeatT", kSFBool, "TRUE"), event_out("duration_changed", kSFTime), event_out("isActive", kSFBool),
};
constexpr FieldSpec kNavigationInfoFields[] = {
    event_in("set_bind", kSFBool),
    exposed("avatarSize", kMFFloat, "[ 0.25, 1.6, 0.75 ]", kShouldBeNonNegative),
    exposed("headlight", kSFBool, "TRUE"),
    exposed("speed", kSFFloat, "1.0", kShouldBeNonNegative),
    exposed("type", kMFString, "[ \"WALK\", \"ANY\" ]"),
    exposed("visibilityLimit", kSFFloat, "0.0", kShouldBeNonNegative),
    event_out("isBound", kSFBool),
};
constexpr FieldSpec kNormalFields[] = {
    exposed("vector", kMFVec3f, "[ ]"),
};
constexpr FieldSpec kNormalInterpolatorFields[] = {
    event_in("set_fraction", kSFFloat),
    exposed("key", kMFFloat, "[ ]"),
    exposed("keyValue", kMFVec3f, "[ ]"),
    event_out("value_changed", kMFVec3f),
};
constexpr FieldSpec kOrientationInterpolatorFields[] = {
    event_in("set_fraction", kSFFloat),
    exposed("key", kMFFloat, "[ ]"),
    exposed("keyValue", kMFRotation, "[ ]"),
    event_out("value_changed", kSFRotation),
};
constexpr FieldSpec kPixelTextureFields[] = {
    exposed("image", kSFImage, "0 0 0"),
    field("repeatS", kSFBool, "TRUE"),
    field("repeatT", kSFBool, "TRUE"),
};
constexpr FieldSpec kPlaneSensorFields[] = {
    exposed("autoOffset", kSFBool, "TRUE"),    exposed("enabled", kSFBool, "TRUE"),
    exposed("maxPosition", kSFVec2f, "-1 -1"), exposed("minPosition", kSFVec2f, "0 0"),
    exposed("offset", kSFVec3f, "0 0 0"),      event_out("isActive", kSFBool),
    event_out("trackPoint_changed", kSFVec3f), event_out("translation_changed", kSFVec3f),
};
constexpr FieldSpec kPointLightFields[] = {
    exposed("ambientIntensity", kSFFloat, "0"),
    exposed("attenuation", kSFVec3f, "1 0 0", kShouldBeNonNegative),
    exposed("color", kSFColor, "1 1 1"),
    exposed("intensity", kSFFloat, "1"),
    exposed("location", kSFVec3f, "0 0 0"),
    exposed("on", kSFBool, "TRUE"),
    exposed("radius", kSFFloat, "100", kShouldBeNonNegative),
};
constexpr FieldSpec kPointSetFields[] = {
    node("color", kColor),
    node("coord", kCoordinate),
};
constexpr FieldSpec kPositionInterpolatorFields[] = {
    event_in("set_fraction", kSFFloat),
    exposed("key", kMFFloat, "[ ]"),
    exposed("keyValue", kMFVec3f, "[ ]"),
    event_out("value_changed", kSFVec3f),
};
constexpr FieldSpec kProximitySensorFields[] = {
    exposed("center", kSFVec3f, "0 0 0"),    exposed("size", kSFVec3f, "0 0 0", kShouldBeNonNegative),
    exposed("enabled", kSFBool, "TRUE"),     event_out("isActive", kSFBool),
    event_out("position_changed", kSFVec3f), event_out("orientation_changed", kSFRotation),
    event_out("enterTime", kSFTime),         event_out("exitTime", kSFTime),
};
constexpr FieldSpec kScalarInterpolatorFields[] = {
    event_in("set_fraction", kSFFloat),
    exposed("key", kMFFloat, "[ ]"),
    exposed("keyValue", kMFFloat, "[ ]"),
    event_out("value_changed", kSFFloat),
};
constexpr FieldSpec kScriptFields[] = {
    exposed("url", kMFString, "[ ]"),
    field("directOutput", kSFBool, "FALSE"),
    field("mustEvaluate", kSFBool, "FALSE"),
};
constexpr FieldSpec kShapeFields[] = {
    node("appearance", kAppearance),
    node("geometry", kGeometry),
    field("convexHull", kMFVec3f, "[ ]"),
    field("hierarchyFile", kSFString, "\"\""),
    field("splitThreshold", kSFInt32, "10", kPositive),
};
constexpr FieldSpec kSoundFields[] = {
    exposed("direction", kSFVec3f, "0 0 1"),
    exposed("intensity", kSFFloat, "1"),
    exposed("location", kSFVec3f, "0 0 0"),
    exposed("maxBack", kSFFloat, "10", kShouldBeNonNegative),
    exposed("maxFront", kSFFloat, "10", kShouldBeNonNegative),
    exposed("minBack", kSFFloat, "1", kShouldBeNonNegative),
    exposed("minFront", kSFFloat, "1", kShouldBeNonNegative),
    exposed("priority", kSFFloat, "0"),
    node("source", kSoundSource),
    field("spatialize", kSFBool, "TRUE"),
};
constexpr FieldSpec kSphereFields[] = {
    field("radius", kSFFloat, "1", kSize),
};
constexpr FieldSpec kSphereSensorFields[] = {
    exposed("autoOffset", kSFBool, "TRUE"),     exposed("enabled", kSFBool, "TRUE"),
    exposed("offset", kSFRotation, "0 1 0 0"),  event_out("isActive", kSFBool),
    event_out("rotation_changed", kSFRotation), event_out("trackPoint_changed", kSFVec3f),
};
constexpr FieldSpec kSpotLightFields[] = {
    exposed("ambientIntensity", kSFFloat, "0"),
    exposed("attenuation", kSFVec3f, "1 0 0", kShouldBeNonNegative),
    exposed("beamWidth", kSFFloat, "1.570796", kShouldBePositive),
    exposed("color", kSFColor, "1 1 1"),
    exposed("cutOffAngle", kSFFloat, "0.785398", kShouldBePositive),
    exposed("direction", kSFVec3f, "0 0 -1"),
    exposed("intensity", kSFFloat, "1"),
    exposed("location", kSFVec3f, "0 0 0"),
    exposed("on", kSFBool, "TRUE"),
    exposed("radius", kSFFloat, "100", kShouldBeNonNegative),
};
constexpr FieldSpec kSwitchFields[] = {
    {"choice", kMFNode, Access::kExposedField, "[ ]", Range::kAny, kChild},
    exposed("whichChoice", kSFInt32, "-1"),
};
constexpr FieldSpec kTextFields[] = {
    exposed("string", kMFString, "[ ]"),
    node("fontStyle", kFontStyle),
    exposed("length", kMFFloat, "[ ]", kShouldBeNonNegative),
    exposed("maxExtent", kSFFloat, "0.0", kShouldBeNonNegative),
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
constexpr FieldSpec kTimeSensorFields[] = {
    exposed("cycleInterval", kSFTime, "1", kShouldBePositive),
    exposed("enabled", kSFBool, "TRUE"),
    exposed("loop", kSFBool, "FALSE"),
    exposed("startTime", kSFTime, "0"),
    exposed("stopTime", kSFTime, "0"),
    event_out("cycleTime", kSFTime),
    event_out("fraction_changed", kSFFloat),
    event_out("isActive", kSFBool),
    event_out("time", kSFTime),
};
constexpr FieldSpec kTouchSensorFields[] = {
    exposed("enabled", kSFBool, "TRUE"),     event_out("hitNormal_changed", kSFVec3f),
    event_out("hitPoint_changed", kSFVec3f), event_out("hitTexCoord_changed", kSFVec2f),
    event_out("isActive", kSFBool),          event_out("isOver", kSFBool),
    event_out("touchTime", kSFTime),
};
constexpr FieldSpec kTransformFields[] = {
    event_in("addChildren", kMFNode),
    event_in("removeChildren", kMFNode),
    exposed("center", kSFVec3f, "0 0 0"),
    kChildren,
    field("collisionLayers", kSFInt32, "-1"),
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
    event_in("set_bind", kSFBool),           exposed("fieldOfView", kSFFloat, "0.785398", kShouldBePositive),
    exposed("jump", kSFBool, "TRUE"),        exposed("orientation", kSFRotation, "0 0 1 0"),
    exposed("position", kSFVec3f, "0 0 10"), field("description", kSFString, "\"\""),
    event_out("bindTime", kSFTime),          event_out("isBound", kSFBool),
};
constexpr FieldSpec kVisibilitySensorFields[] = {
    exposed("center", kSFVec3f, "0 0 0"),
    exposed("enabled", kSFBool, "TRUE"),
    exposed("size", kSFVec3f, "0 0 0", kShouldBeNonNegative),
    event_out("enterTime", kSFTime),
    event_out("exitTime", kSFTime),
    event_out("isActive", kSFBool),
};
constexpr FieldSpec kWorldInfoFields[] = {
    field("info", kMFString, "[ ]"),           field("title", kSFString, "\"\""),
    field("worldTimes", kSFBool, "FALSE"),     field("gravity", kSFVec3f, "0 0 0"),
    field("returnBelow", kSFFloat, "-3.4e38"),
};

constexpr NodeType kNodeTypes[] = {
    {"Anchor", kChild, NodeRole::kGroup, kAnchorFields},
    {"Appearance", kAppearance, NodeRole::kDisplay, kAppearanceFields},
    {"AudioClip", kSoundSource, NodeRole::kDisplay, kAudioClipFields},
    {"Background", kChild, NodeRole::kDisplay, kBackgroundFields},
    {"Billboard", kChild, NodeRole::kBillboard, kBillboardFields},
    {"Box", kGeometry, NodeRole::kGeometry, kBoxFields},
    {"Collision", kChild, NodeRole::kCollision, kCollisionFields},
    {"CollisionInterest", kChild, NodeRole::kCollisionInterest, kCollisionInterestFields},
    {"CollisionResponse", kCollisionResponse, NodeRole::kPart, kCollisionResponseFields},
    {"Color", kColor, NodeRole::kDisplay, kColorFields},
    {"ColorInterpolator", kChild, NodeRole::kPart, kColorInterpolatorFields},
    {"Cone", kGeometry, NodeRole::kGeometry, kConeFields},
    {"Coordinate", kCoordinate, NodeRole::kPart, kCoordinateFields},
    {"CoordinateInterpolator", kChild, NodeRole::kPart, kCoordinateInterpolatorFields},
    {"Cylinder", kGeometry, NodeRole::kGeometry, kCylinderFields},
    {"CylinderSensor", kChild, NodeRole::kPart, kCylinderSensorFields},
    {"DirectionalLight", kChild, NodeRole::kDisplay, kDirectionalLightFields},
    {"ElevationGrid", kGeometry, NodeRole::kGeometry, kElevationGridFields},
    {"Extrusion", kGeometry, NodeRole::kGeometry, kExtrusionFields},
    {"Fog", kChild, NodeRole::kDisplay, kFogFields},
    {"FontStyle", kFontStyle, NodeRole::kDisplay, kFontStyleFields},
    {"Group", kChild, NodeRole::kGroup, kGroupFields},
    {"ImageTexture", kTexture, NodeRole::kDisplay, kImageTextureFields},
    {"IndexedFaceSet", kGeometry, NodeRole::kGeometry, kIndexedFaceSetFields},
    {"IndexedLineSet", kGeometry, NodeRole::kGeometry, kIndexedLineSetFields},
    {"Inline", kChild, NodeRole::kInline, kInlineFields},
    {"KeySensor", kChild, NodeRole::kKeySensor, kKeySensorFields},
    {"LOD", kChild, NodeRole::kLod, kLodFields},
    {"Material", kMaterial, NodeRole::kDisplay, kMaterialFields},
    {"MovieTexture", kTexture | kSoundSource, NodeRole::kDisplay, kMovieTextureFields},
    {"NavigationInfo", kChild, NodeRole::kDisplay, kNavigationInfoFields},
    {"Normal", kNormal, NodeRole::kDisplay, kNormalFields},
    {"NormalInterpolator", kChild, NodeRole::kPart, kNormalInterpolatorFields},
    {"OrientationInterpolator", kChild, NodeRole::kPart, kOrientationInterpolatorFields},
    {"PixelTexture", kTexture, NodeRole::kDisplay, kPixelTextureFields},
    {"PlaneSensor", kChild, NodeRole::kPart, kPlaneSensorFields},
    {"PointLight", kChild, NodeRole::kDisplay, kPointLightFields},
    {"PointSet", kGeometry, NodeRole::kGeometry, kPointSetFields},
    {"PositionInterpolator", kChild, NodeRole::kPart, kPositionInterpolatorFields},
    {"ProximitySensor", kChild, NodeRole::kPart, kProximitySensorFields},
    {"ScalarInterpolator", kChild, NodeRole::kPart, kScalarInterpolatorFields},
    {"Script", kChild, NodeRole::kScript, kScriptFields},
    {"Shape", kChild, NodeRole::kShape, kShapeFields},
    {"Sound", kChild, NodeRole::kDisplay, kSoundFields},
    {"Sphere", kGeometry, NodeRole::kGeometry, kSphereFields},
    {"SphereSensor", kChild, NodeRole::kPart, kSphereSensorFields},
    {"SpotLight", kChild, NodeRole::kDisplay, kSpotLightFields},
    {"Switch", kChild, NodeRole::kSwitch, kSwitchFields},
    {"Text", kGeometry, NodeRole::kGeometry, kTextFields},
    {"TextureCoordinate", kTextureCoordinate, NodeRole::kDisplay, kTextureCoordinateFields},
    {"TextureTransform", kTextureTransform, NodeRole::kDisplay, kTextureTransformFields},
    {"TimeSensor", kChild, NodeRole::kPart, kTimeSensorFields},
    {"TouchSensor", kChild, NodeRole::kPart, kTouchSensorFields},
    {"Transform", kChild, NodeRole::kTransform, kTransformFields},
    {"Viewpoint", kChild, NodeRole::kDisplay, kViewpointFields},
    {"VisibilitySensor", kChild, NodeRole::kPart, kVisibilitySensorFields},
    {"WorldInfo", kChild, NodeRole::kDisplay, kWorldInfoFields},
};
static_assert(std::ranges::is_sorted(kNodeTypes, {}, &NodeType::name));

// The index says where the types of each first byte begin in the table; those of the next byte are behind them.
constexpr auto kFirstOfInitial = [] {
  std::array<std::uint8_t, 257> first{};
  for (std::size_t byte = 0, i = 0; byte < first.size(); ++byte) {
    while (i < std::size(kNodeTypes) && static_cast<unsigned char>(kNodeTypes[i].name.front()) < byte) ++i;
    first[byte] = static_cast<std::uint8_t>(i);
  }
  return first;
}();

}  // namespace

std::span<const NodeType> node_types() { return kNodeTypes; }

const NodeType* find_node_type(std::string_view name) {
  const std::size_t initial = name.empty() ? 0 : static_cast<unsigned char>(name.front());
  for (std::size_t i = kFirstOfInitial[initial]; i < kFirstOfInitial[initial + 1]; ++i) {
    if (same_name(kNodeTypes[i].name, name)) return &kNodeTypes[i];
  }
  return nullptr;
}

const FieldSpec* find_field(const NodeType& type, std::string_view name) {
  for (const FieldSpec& field : type.fields) {
    if (same_name(field.name, name)) return &field;
  }
  return nullptr;
}

std::string_view name_of(FieldType type) {
  constexpr std::string_view kNames[] = {"SFBool",     "SFColor",  "SFFloat",    "SFImage",    "SFInt32",  "SFNode",
                                         "SFRotation", "SFString", "SFTime",     "SFVec2f",    "SFVec3f",  "MFColor",
                                         "MFFloat",    "MFInt32",  "MFNode",     "MFRotation", "MFString", "MFTime",
                                         "MFVec2f",    "MFVec3f",  "MFColorRGBA"};
  return kNames[static_cast<std::size_t>(type)];
}

std::optional<FieldType> find_field_type(std::string_view name) {
  for (int type = 0; type <= static_cast<int>(kMFVec3f); ++type) {
    if (name_of(static_cast<FieldType>(type)) == name) return static_cast<FieldType>(type);
  }
  return std::nullopt;
}

std::string_view name_of(Access access) {
  constexpr std::string_view kNames[] = {"field", "exposedField", "eventIn", "eventOut", "content"};
  return kNames[static_cast<std::size_t>(access)];
}

std::optional<Access> find_access(std::string_view name) {
  for (const Access access : {Access::kField, Access::kExposedField, Access::kEventIn, Access::kEventOut}) {
    if (name_of(access) == name) return access;
  }
  return std::nullopt;
}

const FieldSpec& inline_content() { return std::ranges::find(kInlineFields, Access::kContent, &FieldSpec::access)[0]; }

std::string_view name_of_classes(std::uint16_t classes) {
  constexpr std::pair<std::uint16_t, std::string_view> kNames[] = {
      {kChild, "a child of a group"},
      {kAppearance, "an Appearance"},
      {kMaterial, "a Material"},
      {kTexture, "a texture"},
      {kTextureTransform, "a TextureTransform"},
      {kGeometry, "a geometry node"},
      {kCoordinate, "a Coordinate"},
      {kColor, "a Color"},
      {kNormal, "a Normal"},
      {kTextureCoordinate, "a TextureCoordinate"},
      {kFontStyle, "a FontStyle"},
      {kCollisionResponse, "a CollisionResponse"},
      {kSoundSource, "an AudioClip or a MovieTexture"},
  };
  for (const auto& [node_class, name] : kNames) {
    if ((classes & node_class) != 0) return name;
  }
  return "another node";
}

bool sends_events(Access access) { return access == Access::kEventOut || access == Access::kExposedField; }
bool takes_events(Access access) { return access == Access::kEventIn || access == Access::kExposedField; }
bool has_value(Access access) { return access == Access::kField || access == Access::kExposedField; }

std::string_view default_text_of(FieldType type) {
  switch (type) {
    case kSFBool:
      return "FALSE";
    case kSFFloat:
    case kSFInt32:
      return "0";
    case kSFVec2f:
      return "0 0";
    case kSFColor:
    case kSFImage:
    case kSFVec3f:
      return "0 0 0";
    case kSFNode:
      return "NULL";
    case kSFRotation:
      return "0 0 1 0";
    case kSFString:
      return "\"\"";
    case kSFTime:
      return "-1";
    default:
      return "[ ]";
  }
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
    case kMFColorRGBA:
      return 4;
    default:
      return 0;
  }
}

bool is_list(FieldType type) { return type >= kMFColor; }
bool holds_nodes(FieldType type) { return type == kSFNode || type == kMFNode; }

}  // namespace peerd::vrml
