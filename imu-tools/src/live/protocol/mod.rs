//! Protocols of sensors: one a file, from bytes to messages.
