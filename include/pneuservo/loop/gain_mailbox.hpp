// The slot through which gains reach the running loop.
#pragma once
#include <pneuservo/control/ppd2.hpp>
#include <pneuservo/loop/mailbox.hpp>

namespace pneuservo {

/// Posted from outside the loop, values of a valid config; the loop takes them.
class GainMailbox : public Mailbox<Ppd2GainSet> {};

}  // namespace pneuservo
