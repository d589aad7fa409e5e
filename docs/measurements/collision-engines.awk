/^PROTO Walker/ { sub(/\]/, "exposedField SFVec3f velocityVector 0 0 0 exposedField SFRotation rotation 0 1 0 0 ]") }
{ sub(/translation IS translation/, "& velocityVector IS velocityVector rotation IS rotation") }
/^DEF WALKER/ {
  heading = 2.4 * NR % 6.283
  sub(/}/, sprintf("velocityVector %.3f 0 %.3f rotation 0 1 0 %.3f }", 1.2 * sin(heading), 1.2 * cos(heading), heading))
  if (names) interests = interests "CollisionInterest { objectPath \"" $2 "\" interests [" names " ] collisionType 1 }\n"
  names = names " \"" $2 "\""
}
{ print }
END { print interests }
