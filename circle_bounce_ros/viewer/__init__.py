"""A live page in the browser: it shows what is said on the topics, and its buttons call the node's services."""
