#pragma once
#include <cassert>
#include <cstdint>
#include <memory>
#include <utility>

#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// The world model that a peer goes by: the one that it was given, which others share, until it learns that somebody
// moves what nothing moved so far, or edits the scene. All parts of a peer refer to one ModelInForce, not to the model
// itself.
class ModelInForce {
 public:
  explicit ModelInForce(const WorldModel& shared) : model_(&shared) {}  // `shared` outlives this
  ModelInForce(const ModelInForce&) = delete;
  ModelInForce& operator=(const ModelInForce&) = delete;

  [[nodiscard]] const WorldModel& operator*() const { return *model_; }
  [[nodiscard]] const WorldModel* operator->() const { return model_; }

  // Puts `next` in force. Nothing may need the model before, or its scene, any more.
  void replace(std::shared_ptr<const WorldModel> next) {
    assert(next);
    own_ = std::move(next);
    model_ = own_.get();
    ++revision_;
  }
  // A number that changes with the model.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

 private:
  const WorldModel* model_;
  std::shared_ptr<const WorldModel> own_;  // none: the model is shared
  std::uint64_t revision_ = 0;
};

}  // namespace peerd::replication
