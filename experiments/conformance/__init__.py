"""What beamprop is held to: published numbers, closed forms, finite elements and other programs, in one table."""
