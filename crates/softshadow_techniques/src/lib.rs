//! One file a published shadow technique, each a function from a request to a plan
