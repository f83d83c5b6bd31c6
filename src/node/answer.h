// SPDX-License-Identifier: BSD-3-Clause
// How a service answers: its reply has `success` and `message`, and the call itself never fails.
#pragma once

#include <boost/function.hpp>

#include <exception>

namespace rbs {

/// The callback of a service. `handler(request, response)` returns the message of a success, or throws; the message of
/// a refusal is what() of the exception.
template <class Service, class Handler>
boost::function<bool(typename Service::Request&, typename Service::Response&)> answerBy(Handler handler) {
  return [handler](typename Service::Request& request, typename Service::Response& response) {
    try {
      response.message = handler(request, response);
      response.success = true;
    } catch (const std::exception& refusal) {
      response.message = refusal.what();
      response.success = false;
    }
    return true;
  };
}

}  // namespace rbs
