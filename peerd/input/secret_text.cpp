#include "peerd/input/secret_text.hpp"

#include <string.h>  // explicit_bzero, which is no part of C++

namespace peerd {

SecretText::~SecretText() { explicit_bzero(text_.data(), text_.size()); }

bool SecretText::append(char c) {
  if (size_ == text_.size()) return false;
  text_[size_++] = c;
  return true;
}

}  // namespace peerd
