#pragma once
#include <cassert>
#include <cstdint>
#include <memory>
#include <utility>

#include "replication/world/world_model.hpp"

namespace peerd::replication {

// The world model that a peer goes by: the one that it was given, which others share, until it learns that somebody
// moves what nothing moved so far. All parts of a peer refer to one ModelInForce, not to the model itself.
class ModelInForce {
 public:
  explicit ModelInForce(const WorldModel& shared) : model_(&shared) {}  // `shared` outlives this
  ModelInForce(const ModelInForce&) = delete;
  ModelInForce& operator=(const ModelInForce&) = delete;

  [[nodiscard]] const WorldModel& operator*() const { return *model_; }
  [[nodiscard]] const WorldModel* operator->() const { return model_; }

  // Puts `next`, of the same scene, in force. Nothing may need the model before any more.
  void replace(std::unique_ptr<const WorldModel> next) {
    assert(next && next->scene == model_->scene);
    own_ = std::move(next);
    model_ = own_.get();
    ++revision_;
  }
  // A number that changes with the model.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

 private:
  const WorldModel* model_;
  std::unique_ptr<const WorldModel> own_;  // none: the model is shared
  std::uint64_t revision_ = 0;
};

}  // namespace peerd::replication
