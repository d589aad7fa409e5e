#pragma once

namespace peerd::vrml {

// One world in three languages. It has all geometry nodes, interpolators and sensors of VRML97, PROTO and EXTERNPROTO,
// a Script, a Switch, an LOD, an Inline and ROUTEs. The texts keep the order of their nodes.
inline constexpr const char* kInVrml97 = R"~(#VRML V2.0 utf8
PROTO Ball [ field SFFloat r 2 exposedField SFVec3f place 0 0 0 eventIn SFVec3f move field MFNode more [ ] field SFNode look NULL ]
{ DEF T Transform { translation IS place set_translation IS move children [ Shape { appearance IS look geometry Sphere { radius IS r } } Group { children IS more } ] } }
EXTERNPROTO Lib [ field SFFloat size ] "lib.wrl#Lib"
WorldInfo { title "a \"world\"" info [ "one" "two, \\ three" ] }
Viewpoint { description "v" position 0 1 20 }
NavigationInfo { type [ "WALK" "ANY" ] }
Background { skyColor [ 0 0 1, 1 1 1 ] skyAngle 1.5 }
DirectionalLight { intensity 0.5 on FALSE }
DEF TR Transform {
  translation 1 2 3 rotation 0 1 0 1.5 scale 1 2 1
  children [
    DEF SH Shape { appearance DEF A Appearance { material DEF M Material { diffuseColor 1 0 0 transparency 0.5 } texture ImageTexture { url "a.png" repeatS FALSE } textureTransform TextureTransform { scale 2 2 } } geometry DEF B Box { size 1 2 3 } }
    Shape { appearance USE A geometry Cone { height 3 side FALSE } }
    Shape { geometry Cylinder { radius 0.5 } }
    Shape { geometry Sphere { radius 0.25 } }
    Shape { geometry IndexedFaceSet { coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } color Color { color [ 1 0 0, 0 1 0, 0 0 1, 1 1 1 ] } normal Normal { vector [ 0 0 1, 0 0 1, 0 0 1, 0 0 1 ] } texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] } coordIndex [ 0 1 2 3 -1 ] solid FALSE } }
    Shape { geometry IndexedLineSet { coord USE C coordIndex [ 0 1 2 -1 2 3 -1 ] } }
    Shape { geometry PointSet { coord USE C } }
    Shape { geometry ElevationGrid { xDimension 2 zDimension 2 height [ 0 1 2 3 ] } }
    Shape { geometry Extrusion { spine [ 0 0 0, 0 1 0, 0 2 1 ] crossSection [ 1 1, 1 -1, -1 -1, 1 1 ] } }
    Shape { geometry Text { string [ "a b" "c" ] fontStyle FontStyle { size 2 family "SANS" } } }
  ]
}
Group { children [ USE SH ] }
Switch { whichChoice 1 choice [ Group { } Shape { geometry USE B } ] }
LOD { range [ 10 20 ] level [ Group { } Group { } Group { } ] }
Collision { collide FALSE proxy Shape { geometry Box { } } children Shape { geometry Sphere { } } }
Anchor { url "b.wrl" children Billboard { axisOfRotation 0 0 0 } }
Inline { url "in.wrl" }
DEF TS TimeSensor { cycleInterval 4 loop TRUE }
DEF PI PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }
DEF OI OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 3 ] }
DEF CI CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }
DEF CO ColorInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }
DEF NI NormalInterpolator { key [ 0 1 ] keyValue [ 0 0 1, 1 0 0 ] }
DEF SI ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] }
DEF TC TouchSensor { }
DEF PS PlaneSensor { minPosition 0 0 maxPosition 1 1 }
CylinderSensor { diskAngle 0.5 }
SphereSensor { offset 0 1 0 1 }
ProximitySensor { size 1 2 3 }
VisibilitySensor { size 1 1 1 }
Sound { source DEF AC AudioClip { url "a.wav" loop TRUE } }
Sound { source MovieTexture { url "a.mpg" } maxFront 20 }
Fog { visibilityRange 20 }
PointLight { radius 20 }
SpotLight { beamWidth 1 cutOffAngle 1.5 }
Shape { appearance Appearance { texture PixelTexture { image 2 1 3 0xFF0000 0x00FF00 } } geometry Box { } }
DEF S Script { eventIn SFFloat x eventOut SFBool y field SFNode n USE TR field MFString words [ "a" "b" ] url "ecmascript: function x(v) { y = v < 1 && true; }" }
DEF BA Ball { r 3 look USE A more [ Shape { geometry Box { } } Shape { geometry Cone { } } ] }
Ball { place 5 0 0 }
Lib { size 4 }
ROUTE TS.fraction_changed TO PI.set_fraction
ROUTE PI.value_changed TO TR.set_translation
ROUTE TS.fraction_changed TO OI.set_fraction
ROUTE OI.value_changed TO TR.rotation
ROUTE SI.value_changed TO S.x
ROUTE S.y TO TS.enabled
ROUTE PI.value_changed TO BA.move
)~";

inline constexpr const char* kInClassic = R"~(#X3D V3.3 utf8
PROFILE Immersive
COMPONENT CADGeometry:2
META "title" "a.x3dv"
PROTO Ball [ initializeOnly SFFloat r 2 inputOutput SFVec3f place 0 0 0 inputOnly SFVec3f move initializeOnly MFNode more [ ] initializeOnly SFNode look NULL ]
{ DEF T Transform { translation IS place set_translation IS move children [ Shape { appearance IS look geometry Sphere { radius IS r } } Group { children IS more } ] } }
EXTERNPROTO Lib [ initializeOnly SFFloat size ] "lib.wrl#Lib"
WorldInfo { title "a \"world\"" info [ "one" "two, \\ three" ] }
Viewpoint { description "v" position 0 1 20 }
NavigationInfo { type [ "WALK" "ANY" ] }
Background { skyColor [ 0 0 1, 1 1 1 ] skyAngle 1.5 }
DirectionalLight { intensity 0.5 on FALSE }
DEF TR Transform {
  translation 1 2 3 rotation 0 1 0 1.5 scale 1 2 1
  children [
    DEF SH Shape { appearance DEF A Appearance { material DEF M Material { diffuseColor 1 0 0 transparency 0.5 } texture ImageTexture { url "a.png" repeatS FALSE } textureTransform TextureTransform { scale 2 2 } } geometry DEF B Box { size 1 2 3 } }
    Shape { appearance USE A geometry Cone { height 3 side FALSE } }
    Shape { geometry Cylinder { radius 0.5 } }
    Shape { geometry Sphere { radius 0.25 } }
    Shape { geometry IndexedFaceSet { coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } color Color { color [ 1 0 0, 0 1 0, 0 0 1, 1 1 1 ] } normal Normal { vector [ 0 0 1, 0 0 1, 0 0 1, 0 0 1 ] } texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] } coordIndex [ 0 1 2 3 -1 ] solid FALSE } }
    Shape { geometry IndexedLineSet { coord USE C coordIndex [ 0 1 2 -1 2 3 -1 ] } }
    Shape { geometry PointSet { coord USE C } }
    Shape { geometry ElevationGrid { xDimension 2 zDimension 2 height [ 0 1 2 3 ] } }
    Shape { geometry Extrusion { spine [ 0 0 0, 0 1 0, 0 2 1 ] crossSection [ 1 1, 1 -1, -1 -1, 1 1 ] } }
    Shape { geometry Text { string [ "a b" "c" ] fontStyle FontStyle { size 2 family "SANS" } } }
  ]
}
Group { children [ USE SH ] }
Switch { whichChoice 1 children [ Group { } Shape { geometry USE B } ] }
LOD { range [ 10 20 ] children [ Group { } Group { } Group { } ] }
Collision { enabled FALSE proxy Shape { geometry Box { } } children Shape { geometry Sphere { } } }
Anchor { url "b.wrl" children Billboard { axisOfRotation 0 0 0 } }
Inline { url "in.wrl" }
DEF TS TimeSensor { cycleInterval 4 loop TRUE }
DEF PI PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }
DEF OI OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 3 ] }
DEF CI CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }
DEF CO ColorInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }
DEF NI NormalInterpolator { key [ 0 1 ] keyValue [ 0 0 1, 1 0 0 ] }
DEF SI ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] }
DEF TC TouchSensor { }
DEF PS PlaneSensor { minPosition 0 0 maxPosition 1 1 }
CylinderSensor { diskAngle 0.5 }
SphereSensor { offset 0 1 0 1 }
ProximitySensor { size 1 2 3 }
VisibilitySensor { size 1 1 1 }
Sound { source DEF AC AudioClip { url "a.wav" loop TRUE } }
Sound { source MovieTexture { url "a.mpg" } maxFront 20 }
Fog { visibilityRange 20 }
PointLight { radius 20 }
SpotLight { beamWidth 1 cutOffAngle 1.5 }
Shape { appearance Appearance { texture PixelTexture { image 2 1 3 0xFF0000 0x00FF00 } } geometry Box { } }
DEF S Script { inputOnly SFFloat x outputOnly SFBool y initializeOnly SFNode n USE TR initializeOnly MFString words [ "a" "b" ] url "ecmascript: function x(v) { y = v < 1 && true; }" }
DEF BA Ball { r 3 look USE A more [ Shape { geometry Box { } } Shape { geometry Cone { } } ] }
Ball { place 5 0 0 }
Lib { size 4 }
ROUTE TS.fraction_changed TO PI.set_fraction
ROUTE PI.value_changed TO TR.set_translation
ROUTE TS.fraction_changed TO OI.set_fraction
ROUTE OI.value_changed TO TR.rotation
ROUTE SI.value_changed TO S.x
ROUTE S.y TO TS.enabled
ROUTE PI.value_changed TO BA.move
)~";

inline constexpr const char* kInXml = R"~(<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE X3D PUBLIC "ISO//Web3D//DTD X3D 3.3//EN" "http://www.web3d.org/specifications/x3d-3.3.dtd">
<X3D profile="Immersive" version="3.3" xmlns:xsd="http://www.w3.org/2001/XMLSchema-instance">
<head><component name="CADGeometry" level="2"/><meta name="title" content="a.x3d"/></head>
<Scene>
<ProtoDeclare name="Ball"><ProtoInterface>
  <field accessType="initializeOnly" type="SFFloat" name="r" value="2"/>
  <field accessType="inputOutput" type="SFVec3f" name="place" value="0 0 0"/>
  <field accessType="inputOnly" type="SFVec3f" name="move"/>
  <field accessType="initializeOnly" type="MFNode" name="more"/>
  <field accessType="initializeOnly" type="SFNode" name="look"/>
</ProtoInterface><ProtoBody>
  <Transform DEF="T"><IS><connect nodeField="translation" protoField="place"/><connect nodeField="set_translation" protoField="move"/></IS>
    <Shape><IS><connect nodeField="appearance" protoField="look"/></IS><Sphere><IS><connect nodeField="radius" protoField="r"/></IS></Sphere></Shape>
    <Group><IS><connect nodeField="children" protoField="more"/></IS></Group>
  </Transform></ProtoBody></ProtoDeclare>
<ExternProtoDeclare name="Lib" url='"lib.wrl#Lib"'><field accessType="initializeOnly" type="SFFloat" name="size"/></ExternProtoDeclare>
<WorldInfo title='a "world"' info='"one" "two, \\ three"'/>
<Viewpoint description="v" position="0 1 20"/>
<NavigationInfo type='"WALK" "ANY"'/>
<Background skyColor="0 0 1, 1 1 1" skyAngle="1.5"/>
<DirectionalLight intensity="0.5" on="false"/>
<Transform DEF="TR" translation="1 2 3" rotation="0 1 0 1.5" scale="1 2 1">
  <Shape DEF="SH"><Appearance DEF="A"><Material DEF="M" diffuseColor="1 0 0" transparency="0.5"/><ImageTexture url='"a.png"' repeatS="false"/><TextureTransform scale="2 2"/></Appearance><Box DEF="B" size="1 2 3"/></Shape>
  <Shape><Appearance USE="A"/><Cone height="3" side="false"/></Shape>
  <Shape><Cylinder radius="0.5"/></Shape>
  <Shape><Sphere radius="0.25"/></Shape>
  <Shape><IndexedFaceSet coordIndex="0 1 2 3 -1" solid="false"><Coordinate DEF="C" point="0 0 0, 1 0 0, 1 1 0, 0 1 0"/><Color color="1 0 0, 0 1 0, 0 0 1, 1 1 1"/><Normal vector="0 0 1, 0 0 1, 0 0 1, 0 0 1"/><TextureCoordinate point="0 0, 1 0, 1 1, 0 1"/></IndexedFaceSet></Shape>
  <Shape><IndexedLineSet coordIndex="0 1 2 -1 2 3 -1"><Coordinate USE="C"/></IndexedLineSet></Shape>
  <Shape><PointSet><Coordinate USE="C"/></PointSet></Shape>
  <Shape><ElevationGrid xDimension="2" zDimension="2" height="0 1 2 3"/></Shape>
  <Shape><Extrusion spine="0 0 0, 0 1 0, 0 2 1" crossSection="1 1, 1 -1, -1 -1, 1 1"/></Shape>
  <Shape><Text string='"a b" "c"'><FontStyle size="2" family='"SANS"'/></Text></Shape>
</Transform>
<Group><Shape USE="SH"/></Group>
<Switch whichChoice="1"><Group/><Shape><Box USE="B"/></Shape></Switch>
<LOD range="10 20"><Group/><Group/><Group/></LOD>
<Collision enabled="false"><Shape containerField="proxy"><Box/></Shape><Shape><Sphere/></Shape></Collision>
<Anchor url='"b.wrl"'><Billboard axisOfRotation="0 0 0"/></Anchor>
<Inline url='"in.wrl"'/>
<TimeSensor DEF="TS" cycleInterval="4" loop="true"/>
<PositionInterpolator DEF="PI" key="0 1" keyValue="0 0 0, 1 1 1"/>
<OrientationInterpolator DEF="OI" key="0 1" keyValue="0 1 0 0, 0 1 0 3"/>
<CoordinateInterpolator DEF="CI" key="0 1" keyValue="0 0 0, 1 1 1"/>
<ColorInterpolator DEF="CO" key="0 1" keyValue="0 0 0, 1 1 1"/>
<NormalInterpolator DEF="NI" key="0 1" keyValue="0 0 1, 1 0 0"/>
<ScalarInterpolator DEF="SI" key="0 1" keyValue="0 1"/>
<TouchSensor DEF="TC"/>
<PlaneSensor DEF="PS" minPosition="0 0" maxPosition="1 1"/>
<CylinderSensor diskAngle="0.5"/>
<SphereSensor offset="0 1 0 1"/>
<ProximitySensor size="1 2 3"/>
<VisibilitySensor size="1 1 1"/>
<Sound><AudioClip DEF="AC" url='"a.wav"' loop="true"/></Sound>
<Sound maxFront="20"><MovieTexture url='"a.mpg"'/></Sound>
<Fog visibilityRange="20"/>
<PointLight radius="20"/>
<SpotLight beamWidth="1" cutOffAngle="1.5"/>
<Shape><Appearance><PixelTexture image="2 1 3 0xFF0000 0x00FF00"/></Appearance><Box/></Shape>
<Script DEF="S"><field accessType="inputOnly" type="SFFloat" name="x"/><field accessType="outputOnly" type="SFBool" name="y"/><field accessType="initializeOnly" type="SFNode" name="n"><Transform USE="TR"/></field><field accessType="initializeOnly" type="MFString" name="words" value='"a" "b"'/>
<![CDATA[ecmascript: function x(v) { y = v < 1 && true; }]]></Script>
<ProtoInstance DEF="BA" name="Ball"><fieldValue name="r" value="3"/><fieldValue name="look"><Appearance USE="A"/></fieldValue><fieldValue name="more"><Shape><Box/></Shape><Shape><Cone/></Shape></fieldValue></ProtoInstance>
<ProtoInstance name="Ball"><fieldValue name="place" value="5 0 0"/></ProtoInstance>
<ProtoInstance name="Lib"><fieldValue name="size" value="4"/></ProtoInstance>
<ROUTE fromNode="TS" fromField="fraction_changed" toNode="PI" toField="set_fraction"/>
<ROUTE fromNode="PI" fromField="value_changed" toNode="TR" toField="set_translation"/>
<ROUTE fromNode="TS" fromField="fraction_changed" toNode="OI" toField="set_fraction"/>
<ROUTE fromNode="OI" fromField="value_changed" toNode="TR" toField="rotation"/>
<ROUTE fromNode="SI" fromField="value_changed" toNode="S" toField="x"/>
<ROUTE fromNode="S" fromField="y" toNode="TS" toField="enabled"/>
<ROUTE fromNode="PI" fromField="value_changed" toNode="BA" toField="move"/>
</Scene></X3D>
)~";

inline constexpr const char* kInlinedFile = "#VRML V2.0 utf8\nShape { geometry Box { size 9 9 9 } }\n";
inline constexpr const char* kLibraryFile =
    "#VRML V2.0 utf8\nPROTO Lib [ field SFFloat size 1 ] { Shape { geometry Sphere { radius IS size } } }\n";

}  // namespace peerd::vrml
