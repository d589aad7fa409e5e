#pragma once

namespace peerd {

struct WriteOptions {
  // With this, an Inline that was read stays an Inline with its URL. Otherwise it is written as a Group of its content,
  // so that the text needs no other file to be read. (A node outside of an Inline that a CollisionInterest in it names,
  // as a last resort, may then be another one: names inside of PROTOs have become names of the world.)
  bool keep_inlines = false;
};

}  // namespace peerd
