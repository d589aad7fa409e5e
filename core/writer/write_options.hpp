#pragma once

namespace peerd {

struct WriteOptions {
  // An Inline that was read stays an Inline with its URL. Otherwise it is written as a Group of what it holds, so that
  // the text needs no other file to be read. (What an Inline's own CollisionInterests name outside of it, as a last
  // resort, may then be another node: names inside of PROTOs have become names of the world.)
  bool keep_inlines = false;
};

}  // namespace peerd
