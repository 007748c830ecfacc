#include "tools/spy/lcm_reassembler.hpp"

#include <algorithm>

namespace slamsensor::tools {

void LcmReassembler::forget(Sets::iterator set) {
  held_ -= set->bytes;
  sets_.erase(set);
}

void LcmReassembler::drop(Sets::iterator set) {
  forget(set);
  ++dropped_;
}

void LcmReassembler::keep_within_bounds() {
  while (sets_.size() > kSetsMax || held_ > kBytesMax) {
    drop(sets_.begin());
  }
}

LcmReassembler::Sets::iterator LcmReassembler::find_or_begin(std::uint64_t sender, const LcmPacket& packet) {
  auto found = std::find_if(sets_.begin(), sets_.end(), [&](const Set& set) {
    return set.sender == sender && set.sequence == packet.sequence;
  });
  if (found != sets_.end() &&
      (found->message_bytes != packet.message_bytes || found->fragments != packet.fragments)) {
    drop(found);  // the sender has started again, and counts from the same number
    found = sets_.end();
  }
  if (found == sets_.end()) {
    return sets_.insert(sets_.end(), {.sender = sender,
                                      .sequence = packet.sequence,
                                      .channel = {},
                                      .message_bytes = packet.message_bytes,
                                      .fragments = packet.fragments,
                                      .pieces = {},
                                      .bytes = 0});
  }
  return found;
}

void LcmReassembler::assemble(const Set& set) {
  channel_ = set.channel;
  message_.assign(set.message_bytes, 0);
  for (const auto& [fragment, piece] : set.pieces) {
    std::copy(piece.bytes.begin(), piece.bytes.end(), message_.begin() + piece.offset);
  }
}

std::optional<LcmMessageView> LcmReassembler::push(std::uint64_t sender, const LcmPacket& packet) {
  if (packet.fragments == 1 && packet.data.size() == packet.message_bytes) {
    return LcmMessageView{packet.channel, packet.data};
  }
  const auto set = find_or_begin(sender, packet);
  if (set->pieces.count(packet.fragment) > 0) {
    return std::nullopt;
  }
  // Together the fragments are as long as the message: more than that is a lie, and less at the end too.
  set->bytes += packet.data.size();
  held_ += packet.data.size();
  set->pieces[packet.fragment] = {packet.offset, {packet.data.begin(), packet.data.end()}};
  if (packet.fragment == 0) {
    set->channel = packet.channel;
  }
  const bool is_last = set->pieces.size() == set->fragments;
  if (set->bytes > set->message_bytes || (is_last && set->bytes < set->message_bytes)) {
    drop(set);
    return std::nullopt;
  }
  if (!is_last) {
    keep_within_bounds();
    return std::nullopt;
  }
  assemble(*set);
  forget(set);
  return LcmMessageView{channel_, message_};
}

}  // namespace slamsensor::tools
