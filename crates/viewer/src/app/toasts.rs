//! Messages that appear, stay for a while and fade. Knows nothing of drawing.

use std::collections::VecDeque;

/// Messages that are shown at once; the oldest goes when there is another.
const MOST: usize = 4;
/// Seconds in which a message fades at its end.
const FADE_SECS: f32 = 1.0;

/// What a message is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToastKind {
    /// Something was done, or is good to know.
    Note,
    /// Something was refused or went wrong.
    Error,
}

impl ToastKind {
    /// How long a message of this kind is shown, seconds.
    #[must_use]
    pub const fn shown_secs(self) -> f32 {
        match self {
            ToastKind::Note => 5.0,
            ToastKind::Error => 12.0,
        }
    }
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Toast {
    /// What it is about.
    pub kind: ToastKind,
    /// What it says.
    pub text: String,
    age_secs: f32,
}

impl Toast {
    /// 1 while it is fresh, down to 0 when it goes.
    #[must_use]
    pub fn opacity(&self) -> f32 {
        ((self.kind.shown_secs() - self.age_secs) / FADE_SECS).clamp(0.0, 1.0)
    }
}

/// The messages that are shown, oldest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Toasts(VecDeque<Toast>);

impl Toasts {
    /// Tells of something that was done.
    pub fn note(&mut self, text: impl Into<String>) {
        self.push(ToastKind::Note, text.into());
    }

    /// Tells of something that was refused or went wrong.
    pub fn error(&mut self, text: impl Into<String>) {
        self.push(ToastKind::Error, text.into());
    }

    /// Tells of a state that was changed: `what` and how it is now, in place of an earlier message about the same.
    pub fn replace(&mut self, what: &str, now: impl AsRef<str>) {
        self.0.retain(|toast| !toast.text.starts_with(what));
        self.note(format!("{what}{}", now.as_ref()));
    }

    /// A message that is shown already becomes fresh again.
    fn push(&mut self, kind: ToastKind, text: String) {
        self.0.retain(|toast| toast.text != text);
        if self.0.len() == MOST {
            self.0.pop_front();
        }
        self.0.push_back(Toast { kind, text, age_secs: 0.0 });
    }

    /// Lets `dt` seconds pass.
    pub fn advance(&mut self, dt: f32) {
        self.0.iter_mut().for_each(|toast| toast.age_secs += dt);
        self.0.retain(|toast| toast.age_secs < toast.kind.shown_secs());
    }

    /// Takes one message away, by its place.
    pub fn dismiss(&mut self, index: usize) {
        self.0.remove(index);
    }

    /// The messages, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &Toast> {
        self.0.iter()
    }

    /// True when nothing is shown.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Takes all messages as one text, a line each; `None` when there is none.
    pub fn take_text(&mut self) -> Option<String> {
        let lines: Vec<String> = self.0.drain(..).map(|toast| toast.text).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_fades_and_goes_before_an_error() {
        let mut toasts = Toasts::default();
        toasts.note("saved");
        toasts.error("refused");
        toasts.advance(ToastKind::Note.shown_secs() - 0.5 * FADE_SECS);
        let opacity: Vec<f32> = toasts.iter().map(Toast::opacity).collect();
        assert_eq!(opacity, [0.5, 1.0]);
        toasts.advance(FADE_SECS);
        assert_eq!(toasts.iter().map(|t| t.kind).collect::<Vec<_>>(), [ToastKind::Error]);
        toasts.advance(ToastKind::Error.shown_secs());
        assert!(toasts.is_empty());
    }

    #[test]
    fn a_message_said_again_is_shown_once_and_fresh() {
        let mut toasts = Toasts::default();
        toasts.note("a");
        toasts.note("b");
        toasts.advance(4.9);
        toasts.note("a");
        toasts.advance(0.2);
        assert_eq!(toasts.take_text().as_deref(), Some("a"));
        assert_eq!(toasts.take_text(), None);
    }

    #[test]
    fn a_state_is_told_once_as_it_is_now() {
        let mut toasts = Toasts::default();
        toasts.note("a");
        ["1/2", "1/4"].iter().for_each(|speed| toasts.replace("Speed ", speed));
        assert_eq!(toasts.take_text().as_deref(), Some("a\nSpeed 1/4"));
    }

    #[test]
    fn many_messages_push_out_the_oldest_and_one_can_be_dismissed() {
        let mut toasts = Toasts::default();
        (0..6).for_each(|n| toasts.note(n.to_string()));
        toasts.dismiss(1);
        toasts.dismiss(17);
        assert_eq!(toasts.take_text().as_deref(), Some("2\n4\n5"));
    }
}
