"""What does a table do, asked in angles, points and arc lengths? The map that users call, and what it answers with."""
