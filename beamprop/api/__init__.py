"""The questions a user asks: arguments checked, labelled datasets made. One file a question."""
