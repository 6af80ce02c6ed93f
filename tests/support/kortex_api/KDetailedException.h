#pragma once

#include <exception>

#include <KError.h>

namespace Kinova::Api {

class KBasicException : public std::exception {};

class KDetailedException : public KBasicException {
 public:
  const char* what() const noexcept override;
  KError& getErrorInfo();
};

}  // namespace Kinova::Api
