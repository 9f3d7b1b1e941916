"""Other programs on the same problems: what they are asked, where they run, what they answered."""
