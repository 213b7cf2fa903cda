//! A network in one process that delays, loses and reorders packets, the same ones for the same seed.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use ggrs::{Message, NonBlockingSocket};

/// How bad the network is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Weather {
    /// Time that every packet takes, milliseconds.
    pub latency_ms: u64,
    /// At most so much more, milliseconds.
    pub jitter_ms: u64,
    /// Packets lost, of 100.
    pub loss_percent: u32,
    /// Chooses them.
    pub seed: u64,
}

/// The wire between all sockets.
#[derive(Debug)]
pub struct Wire {
    weather: Weather,
    random: u64,
    under_way: Vec<Packet>,
    /// Packets sent.
    pub sent: u32,
    /// Packets lost.
    pub lost: u32,
}

#[derive(Debug)]
struct Packet {
    at: Instant,
    from: usize,
    to: usize,
    message: Message,
}

/// One player's end of the wire.
#[derive(Debug)]
pub struct Socket {
    wire: Rc<RefCell<Wire>>,
    address: usize,
}

impl Wire {
    /// A wire, to be shared by its sockets.
    #[must_use]
    pub fn new(weather: Weather) -> Rc<RefCell<Self>> {
        let random = weather.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        Rc::new(RefCell::new(Self { weather, random, under_way: Vec::new(), sent: 0, lost: 0 }))
    }

    /// A number below `end`, by xorshift: enough for a network.
    fn below(&mut self, end: u64) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) % end.max(1)
    }
}

impl Socket {
    /// The end of `wire` with an address.
    #[must_use]
    pub fn new(wire: &Rc<RefCell<Wire>>, address: usize) -> Self {
        Self { wire: Rc::clone(wire), address }
    }
}

impl NonBlockingSocket<usize> for Socket {
    fn send_to(&mut self, message: &Message, to: &usize) {
        let mut wire = self.wire.borrow_mut();
        wire.sent += 1;
        if wire.below(100) < u64::from(wire.weather.loss_percent) {
            wire.lost += 1;
            return;
        }
        let (latency, jitter) = (wire.weather.latency_ms, wire.weather.jitter_ms);
        let at = Instant::now() + Duration::from_millis(latency + wire.below(jitter + 1));
        let packet = Packet { at, from: self.address, to: *to, message: message.clone() };
        wire.under_way.push(packet);
    }

    fn receive_all_messages(&mut self) -> Vec<(usize, Message)> {
        let (mut wire, now) = (self.wire.borrow_mut(), Instant::now());
        let own = |packet: &Packet| packet.to == self.address && packet.at <= now;
        let (mut arrived, waiting): (Vec<_>, Vec<_>) =
            std::mem::take(&mut wire.under_way).into_iter().partition(own);
        wire.under_way = waiting;
        arrived.sort_by_key(|packet| packet.at);
        arrived.into_iter().map(|packet| (packet.from, packet.message)).collect()
    }
}
